//! Errors of products of cosine lobes and of lobes for caps, as [Meunier2009, 4.1 and 5.2] and beyond.
//!
//! The integral of a product of two lobes, by rule and by the f32 table; of a chain of three, reflectance, light
//! and blocker; and for caps by angular radius the squared distance and the solid angle of every fit.

use halfshade_sh::lobe::accuracy::{self, Chain, Errors, Triplet};
use halfshade_sh::lobe::{
    CapFit, Lobe, Lobe8, LobeTable, ProductRule, cap_distance, cap_lobe, product, product_integral,
};
use std::f64::consts::{FRAC_PI_2, TAU};

fn print<T>(name: &str, errors: Option<Errors<T>>, place: impl Fn(&T) -> String) {
    let Some(e) = errors else { return };
    #[expect(clippy::print_stdout, reason = "the example's output")]
    {
        println!(
            "{name:44} {:9.2e} {:9.2e} {:9.2e} {:9.2e} {:9.2e}  {}",
            e.mean,
            e.variance,
            e.median,
            e.p99,
            e.worst,
            place(&e.worst_at)
        );
    }
}

fn title(text: &str) {
    #[expect(clippy::print_stdout, reason = "the example's output")]
    {
        println!("\n{text}");
        println!("{:44} {:>9} {:>9} {:>9} {:>9} {:>9}  worst at", "", "mean", "variance", "median", "p99", "worst");
    }
}

fn main() {
    let tables = ProductRule::ALL.map(LobeTable::build);
    let by_table = |index: usize| {
        let table = &tables[index];
        move |a: &Lobe, b: &Lobe| table.product8(&Lobe8::splat(a), &Lobe8::splat(b)).lane(0).integral()
    };
    let direct_by_table =
        |a: &Lobe, b: &Lobe| f64::from(tables[0].product_integral8(&Lobe8::splat(a), &Lobe8::splat(b)).to_array()[0]);
    let place = |t: &Triplet| format!("e {:.3} and {:.3}, {:.3} rad", t.e1, t.e2, t.angle);
    let triplets = accuracy::sampled_triplets(65);
    let published = |a: &Lobe, b: &Lobe| product(a, b, ProductRule::Published).integral();

    title("Integral of a product, steradians, over the samples of the paper (it states 7.1e-4, 1.2e-8, 0)");
    print("published, direct fit", accuracy::absolute_errors(&triplets, published), place);
    for (index, rule) in ProductRule::ALL.iter().enumerate() {
        print(&format!("{rule:?}, f32 table"), accuracy::absolute_errors(&triplets, by_table(index)), place);
    }
    print("integral without a lobe, f32 table", accuracy::absolute_errors(&triplets, direct_by_table), place);

    let chosen = |keep: fn(&Triplet) -> bool| -> Vec<Triplet> { triplets.iter().copied().filter(keep).collect() };
    for (name, chosen) in [
        ("all", triplets.clone()),
        ("axes within 0.1 of a right angle", chosen(|t| (t.angle - FRAC_PI_2).abs() < 0.1)),
        ("exponents of at least 1", chosen(|t| t.e1 >= 1.0)),
    ] {
        title(&format!("The same, relative, where the integral is above 1e-6: {name}"));
        print("published, direct fit", accuracy::relative_errors(&chosen, 1e-6, published), place);
        for (index, rule) in ProductRule::ALL.iter().enumerate() {
            print(&format!("{rule:?}, f32 table"), accuracy::relative_errors(&chosen, 1e-6, by_table(index)), place);
        }
        print("integral without a lobe, f32 table", accuracy::relative_errors(&chosen, 1e-6, direct_by_table), place);
    }

    let chains = accuracy::chains(4000);
    let diffuse = |chain: &Chain| {
        let [first, rest @ ..] = *chain;
        [Lobe { exponent: 1.0, ..first }, rest[0], rest[1]]
    };
    // Caps of 15 degrees to a hemisphere.
    let wide = |chain: &Chain| chain.map(|lobe| Lobe { exponent: 0.6 * lobe.exponent.powf(0.45), ..lobe });
    let sets = [
        ("glossy reflectance of 1 to 100, light and blocker of 10 to 10000", chains.clone()),
        ("diffuse reflectance", chains.iter().map(diffuse).collect()),
        ("exponents of 0.6 to 38", chains.iter().map(wide).collect()),
    ];
    let exponents = |c: &Chain| format!("e {:.1}, {:.1}, {:.1}", c[0].exponent, c[1].exponent, c[2].exponent);
    for (name, chains) in &sets {
        title(&format!("Chain of three as a fraction of the first two's integral: {name}"));
        for (index, rule) in ProductRule::ALL.into_iter().enumerate() {
            let lobes = |c: &Chain| product(&product(&c[0], &c[1], rule), &c[2], rule).integral();
            print(&format!("{rule:?} twice, f64"), accuracy::chain_errors(chains, lobes), exponents);
            let last = |c: &Chain| product_integral(&product(&c[0], &c[1], rule), &c[2]);
            print(&format!("{rule:?}, then the integral, f64"), accuracy::chain_errors(chains, last), exponents);
            let table = &tables[index];
            let batch = |c: &Chain| {
                let [a, b, c] = c.map(|lobe| Lobe8::splat(&lobe));
                f64::from(table.product_integral8(&table.product8(&a, &b), &c).to_array()[0])
            };
            print(&format!("{rule:?}, then the integral, f32"), accuracy::chain_errors(chains, batch), exponents);
        }
    }

    #[expect(clippy::print_stdout, reason = "the example's output")]
    {
        println!("\nCaps: squared distance over solid angle, and solid angle of the lobe over the cap's");
        println!("{:>8} {:?}", "radians", CapFit::ALL);
        for radius in [0.001, 0.1, 0.3, 0.6, 0.9, 1.2, 1.3, 1.4, 1.5, 1.55] {
            let versine = 1.0 - f64::cos(radius);
            let of = |fit: CapFit| {
                let lobe = cap_lobe([0.0, 0.0, 1.0], versine, fit);
                format!("{:.4} {:.4}", cap_distance(versine, &lobe), lobe.integral() / (TAU * versine))
            };
            println!("{radius:8} {}", CapFit::ALL.map(of).join("   "));
        }
    }
}
