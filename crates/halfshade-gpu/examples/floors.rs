//! Floors of the kernels: operations and bytes per receiver, and what they allow on a graphics processor.
//!
//! `cargo run -p halfshade-gpu --example floors` prints a table. Operations in single precision are counted in the shaders as
//! they are parsed, a fused multiplication and addition as two, a square root as one. Loops count as often as said, and of
//! branches the side that is said to be taken, or else the longer one.

#![expect(clippy::print_stdout, reason = "its result")]

use halfshade_gpu::kernels::{KERNELS, Kernel};
use naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, MathFunction, Module, ScalarKind, Statement,
    TypeInner,
    valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator},
};

/// An H100 SXM by its data sheet: single precision, and memory.
const OPERATIONS_PER_SEC: f64 = 67e12;
const BYTES_PER_SEC: f64 = 3.35e12;

/// A shader whose operations are counted.
struct Counter<'a> {
    module: Module,
    info: ModuleInfo,
    case: &'a Case,
}

/// A kernel at work.
struct Case {
    kernel: &'static str,
    what: &'static str,
    bands: usize,
    /// By function: how often its loops go round, in their order.
    rounds: &'static [(&'static str, &'static [f64])],
    /// By function: which side of its branches is taken, in their order.
    taken: &'static [(&'static str, &'static [bool])],
    /// Read and written per receiver, without what a cache holds for all.
    bytes: f64,
}

/// Place, albedo and radiance of a receiver.
const RECEIVER_BYTES: f64 = 32.0 + 12.0 + 12.0;

const CASES: &[Case] = &[
    Case {
        kernel: "unshadowed",
        what: "a map's light by normal, no lamp",
        bands: 1,
        rounds: &[("local_lights", &[0.0]), ("main", &[0.0])],
        taken: &[],
        bytes: RECEIVER_BYTES,
    },
    Case {
        kernel: "sh-exp",
        what: "shadows of 64 spheres, hybrid with three squarings, 4 bands, constant light",
        bands: 4,
        rounds: &[("log_sum", &[64.0]), ("exponential", &[3.0, 3.0]), ("exp_minus_one", &[8.0])],
        taken: &[
            // Nothing reflects, logarithms are summed, nothing is a ground.
            ("main", &[false, false, true, false, false, false]),
            ("inner_form", &[true]),
            ("light", &[true]),
            ("sun", &[true]),
            ("zonal", &[false]),
        ],
        bytes: RECEIVER_BYTES,
    },
    Case {
        kernel: "sh-exp",
        what: "the same and reflections of the 64 spheres, grey, without squarings",
        bands: 4,
        rounds: &[
            ("nearest_after", &[64.0]),
            ("gather", &[8.0, 8.0]),
            ("radiated", &[1.0, 4.0]),
            ("exponential", &[3.0, 3.0]),
            ("exp_minus_one", &[8.0]),
        ],
        taken: &[
            ("main", &[false, true, true, false, false, false]),
            // In order, handed on from sphere to sphere.
            ("gather", &[true, false, false, false, false]),
            ("exponential_dot", &[false]),
            ("inner_form", &[true]),
            ("light", &[true]),
            ("sun", &[true]),
            ("zonal", &[false]),
        ],
        bytes: RECEIVER_BYTES,
    },
    Case {
        kernel: "ray-traced",
        what: "16 rays of 32 steps through hierarchies each, a map's light, no lamp",
        bands: 1,
        // A map of three levels of cells, and a sun that gets half of the rays.
        rounds: &[
            ("add_product", &[2.0]),
            ("draw_products", &[2.0, 8.0]),
            ("is_blocked", &[32.0, 1.0]),
            ("irradiance_at", &[0.0]),
            ("map_sample", &[3.0]),
            ("first_above", &[7.0]),
        ],
        // Nothing is glossy, and nothing has holes.
        taken: &[
            ("main", &[false, false, true]),
            ("add_product", &[false, true, true]),
            ("draw_products", &[false, true, true]),
            ("drawn_for", &[false, false, false]),
            ("finish", &[false]),
            ("is_met", &[false, false, false]),
        ],
        bytes: RECEIVER_BYTES,
    },
    Case {
        kernel: "shadow-field",
        what: "four other objects and the own, 4 bands in 8 bits, a map's light, at a vertex",
        bands: 4,
        rounds: &[("main", &[1.0]), ("gathered", &[1.0]), ("transfer_toward", &[5.0]), ("blocked_at", &[2.0])],
        // Distant light alone, other objects.
        taken: &[("gathered", &[true, true]), ("transfer_toward", &[false])],
        // Four rows of own occlusion, vertices and weights; eight samples of 16 bytes per object.
        bytes: RECEIVER_BYTES + 64.0 + 32.0 + 4.0 * 8.0 * 16.0,
    },
];

fn main() {
    println!(
        "| kernel | at work | kflop per receiver | bytes per receiver | floor, ps | receivers per second at most |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: |");
    for case in CASES {
        let kernel = KERNELS.iter().find(|kernel| kernel.name == case.kernel).expect("in the table");
        let operations = Counter::new(kernel, case).of_entry();
        let secs = (operations / OPERATIONS_PER_SEC).max(case.bytes / BYTES_PER_SEC);
        let (what, kflop, bytes) = (case.what, operations / 1e3, case.bytes);
        println!("| {} | {what} | {kflop:.2} | {bytes} | {:.1} | {:.2e} |", case.kernel, secs * 1e12, secs.recip());
    }
    println!("\nExpected of an H100 SXM (67 TFLOP/s, 3.35 TB/s): not measured.");
}

impl<'a> Counter<'a> {
    fn new(kernel: &Kernel, case: &'a Case) -> Self {
        let module = naga::front::wgsl::parse_str(&kernel.code(Some(case.bands))).expect("parses");
        // Half floats of stored fields are part of WebGPU.
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32);
        let info = validator.validate(&module).expect("is valid");
        Self { module, info, case }
    }

    fn of_entry(&self) -> f64 {
        self.of_function(&self.module.entry_points[0].function, self.info.get_entry_point(0), "main")
    }

    fn of_function(&self, function: &Function, info: &FunctionInfo, name: &str) -> f64 {
        let list = |lists: &'static [(&'static str, &'static [f64])]| lists.iter().find(|(known, _)| *known == name);
        let taken = self.case.taken.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, taken)| taken);
        let rounds = list(self.case.rounds).map_or(&[][..], |(_, rounds)| rounds);
        let mut walk = Walk { counter: self, function, info, taken: taken.iter(), rounds: rounds.iter() };
        walk.of_block(&function.body)
    }

    fn of_call(&self, function: Handle<Function>) -> f64 {
        let called = &self.module.functions[function];
        self.of_function(called, &self.info[function], called.name.as_deref().unwrap_or_default())
    }
}

/// A way through a function.
struct Walk<'a> {
    counter: &'a Counter<'a>,
    function: &'a Function,
    info: &'a FunctionInfo,
    taken: std::slice::Iter<'static, bool>,
    rounds: std::slice::Iter<'static, f64>,
}

impl Walk<'_> {
    fn of_block(&mut self, block: &Block) -> f64 {
        block.iter().map(|statement| self.of_statement(statement)).sum()
    }

    fn of_statement(&mut self, statement: &Statement) -> f64 {
        match statement {
            Statement::Emit(range) => range.clone().map(|expression| self.of_expression(expression)).sum(),
            Statement::Block(block) => self.of_block(block),
            Statement::If { accept, reject, .. } if [accept, reject].map(is_end_of_loop).contains(&true) => 0.0,
            // `a || b` and `a && b` are branches, too: both sides count.
            Statement::If { accept, reject, .. }
                if [accept, reject].map(|side| self.is_known(side)).contains(&true) =>
            {
                self.of_block(accept) + self.of_block(reject)
            }
            Statement::If { accept, reject, .. } => {
                let taken = self.taken.next().copied();
                let sides = [self.of_block(accept), self.of_block(reject)];
                taken.map_or(sides[0].max(sides[1]), |taken| sides[usize::from(!taken)])
            }
            Statement::Loop { body, continuing, .. } => {
                let rounds = self.rounds.next().copied().unwrap_or(1.0);
                rounds * (self.of_block(body) + self.of_block(continuing))
            }
            Statement::Call { function, .. } => self.counter.of_call(*function),
            _ => 0.0,
        }
    }

    /// Whether a side of a branch does no more than store `true` or `false`.
    fn is_known(&self, side: &Block) -> bool {
        let [Statement::Store { value, .. }] = side.iter().as_slice() else { return false };
        matches!(self.function.expressions[*value], Expression::Literal(Literal::Bool(_)))
    }

    fn of_expression(&self, handle: Handle<Expression>) -> f64 {
        let lanes = |handle: Handle<Expression>| match self.info[handle].ty.inner_with(&self.counter.module.types) {
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => 1.0,
            TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => f64::from(*size as u8),
            _ => 0.0,
        };
        let width = lanes(handle);
        match &self.function.expressions[handle] {
            Expression::Binary {
                op: BinaryOperator::Add | BinaryOperator::Subtract | BinaryOperator::Multiply | BinaryOperator::Divide,
                ..
            } => width,
            Expression::Math { fun: MathFunction::Fma | MathFunction::Clamp, .. } => 2.0 * width,
            Expression::Math { fun: MathFunction::Dot, arg, .. } => 2.0 * lanes(*arg) - 1.0,
            Expression::Math { .. } => width,
            _ => 0.0,
        }
    }
}

/// Whether a branch only says when a loop is over.
fn is_end_of_loop(side: &Block) -> bool {
    matches!(side.iter().as_slice(), [Statement::Break])
}
