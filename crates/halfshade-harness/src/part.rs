//! Parts of an experiment: errors in shards on any machines, times on one.
//!
//! The runs of an experiment, in the order of its results, are cut into `count` ranges of like length; a shard is one of them.
//! Errors are the same bits wherever they are measured, so that shards that are joined are the whole. Times aren't: they are
//! measured in one part, on one machine that does nothing else.

use serde::{Deserialize, Serialize};
use std::{fmt, ops::Range, str::FromStr};

/// Most shards that an experiment is cut into: more than any has runs.
const MAX_SHARDS: usize = 1_000_000;

/// The part of an experiment that is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// All of it.
    #[default]
    Whole,
    /// Errors and pictures of a share of its runs.
    Errors(Shard),
    /// Times of all of its runs.
    Times,
}

/// One of several shares of the runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Its number, from 1 on.
    pub number: usize,
    /// Number of shards.
    pub count: usize,
}

/// A shard, as users name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    /// `i/n`.
    This(Shard),
    /// `auto`, or `auto/n`: the number, and without `n` the count, as the scheduler of a cluster tells.
    Auto(Option<usize>),
}

impl Part {
    /// The runs that belong to it, of `count` in all.
    pub fn range(self, count: usize) -> Range<usize> {
        match self {
            Self::Whole | Self::Times => 0..count,
            Self::Errors(shard) => shard.range(count),
        }
    }

    /// Whether times are measured.
    pub fn has_times(self) -> bool {
        !matches!(self, Self::Errors(_))
    }

    /// Whether errors are measured.
    pub fn has_errors(self) -> bool {
        self != Self::Times
    }

    /// Name of its folder.
    pub fn folder_name(self) -> Option<String> {
        match self {
            Self::Whole => None,
            Self::Errors(Shard { number, count }) => Some(format!("errors-{number}-of-{count}")),
            Self::Times => Some("times".into()),
        }
    }
}

/// What is run, for people.
impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => write!(f, "the whole"),
            Self::Errors(shard) => write!(f, "shard {shard}"),
            Self::Times => write!(f, "times"),
        }
    }
}

impl Shard {
    /// The runs that belong to it, of `count` in all: the ranges of all shards follow each other and differ by one at most.
    pub fn range(self, count: usize) -> Range<usize> {
        let bound = |number: usize| (number as u128 * count as u128 / self.count as u128) as usize;
        bound(self.number - 1)..bound(self.number)
    }

    fn new(number: usize, count: usize) -> Result<Self, String> {
        if !(1..=MAX_SHARDS).contains(&count) {
            return Err(format!("{count} shards: expected from 1 to {MAX_SHARDS}"));
        }
        if !(1..=count).contains(&number) {
            return Err(format!("there is no shard {number} of {count}: they are numbered from 1 to {count}"));
        }
        Ok(Self { number, count })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers =
            text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
        let (number, count) = numbers.ok_or("expected NUMBER/COUNT such as 1/8, `auto`, or `auto/COUNT`")?;
        Self::new(number, count)
    }
}

impl FromStr for ShardChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let count = |text: &str| {
            let count = text.parse().ok().filter(|count| (1..=MAX_SHARDS).contains(count));
            count.ok_or_else(|| format!("`auto/COUNT`: expected a whole number from 1 to {MAX_SHARDS}"))
        };
        match text.strip_prefix("auto") {
            Some("") => Ok(Self::Auto(None)),
            Some(rest) if rest.starts_with('/') => Ok(Self::Auto(Some(count(&rest[1..])?))),
            _ => text.parse().map(Self::This),
        }
    }
}

impl ShardChoice {
    /// The shard that is meant, where `variable` gives the values of environment variables.
    ///
    /// # Errors
    /// The reason, where the environment doesn't tell or tells what can't be.
    pub fn shard(self, variable: &dyn Fn(&str) -> Option<String>) -> Result<Shard, String> {
        let wanted = match self {
            Self::This(shard) => return Ok(shard),
            Self::Auto(count) => count,
        };
        let number = |name: &str| {
            let value = variable(name);
            let value =
                value.map(|text| text.trim().parse::<usize>().map_err(|_| format!("{name}={text} is no number")));
            value.transpose()
        };
        let counted = |name: &str, id: usize| {
            let count = wanted.ok_or_else(|| {
                format!("{name} is set, but nothing tells how many tasks there are; say it: --shard auto/COUNT")
            })?;
            Shard::new(id, count).map_err(|problem| format!("{name}={id}: {problem}; number the tasks from 1 on"))
        };
        if let Some(id) = number("SLURM_ARRAY_TASK_ID")? {
            return slurm(id, wanted, &number);
        }
        for name in ["HQ_TASK_ID", "PARALLEL_SEQ"] {
            if let Some(id) = number(name)? {
                return counted(name, id);
            }
        }
        Err("`auto` needs SLURM_ARRAY_TASK_ID, HQ_TASK_ID or PARALLEL_SEQ, which schedulers set; without one say which shard: --shard 1/8".into())
    }
}

/// The shard of a task of a Slurm array, whose numbers may start anywhere but must follow each other.
fn slurm(
    id: usize,
    wanted: Option<usize>,
    number: &dyn Fn(&str) -> Result<Option<usize>, String>,
) -> Result<Shard, String> {
    let told = number("SLURM_ARRAY_TASK_COUNT")?;
    let count = match (wanted, told) {
        (Some(wanted), Some(told)) if wanted != told => {
            return Err(format!("auto/{wanted}, but SLURM_ARRAY_TASK_COUNT={told}: make the array as large as that"));
        }
        (Some(count), _) | (None, Some(count)) => count,
        (None, None) => return Err("SLURM_ARRAY_TASK_COUNT isn't set; say it: --shard auto/COUNT".into()),
    };
    let first = number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(1);
    let last = number("SLURM_ARRAY_TASK_MAX")?.unwrap_or_else(|| (first + count).saturating_sub(1));
    if !(first..=last).contains(&id) || last - first + 1 != count {
        return Err(format!(
            "task {id} of {count} from {first} to {last}: numbers must follow each other, as those of --array=1-{count} do"
        ));
    }
    Shard::new(id - first + 1, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_is_in_one_shard_and_shards_are_alike() {
        for (count, shards) in [(0, 1), (1, 3), (7, 7), (100, 7), (5, 8), (1000, 999)] {
            let ranges: Vec<_> = (1..=shards).map(|number| Shard { number, count: shards }.range(count)).collect();
            let joined: Vec<usize> = ranges.iter().cloned().flatten().collect();
            assert_eq!(joined, (0..count).collect::<Vec<_>>(), "{count} {shards}");
            let lengths = || ranges.iter().map(ExactSizeIterator::len);
            assert!(lengths().max().unwrap() - lengths().min().unwrap() <= 1, "{count} {shards}");
        }
        let last = Shard { number: MAX_SHARDS, count: MAX_SHARDS };
        assert_eq!(last.range(usize::MAX).end, usize::MAX);
        assert_eq!((Part::Whole.range(5), Part::Times.range(5)), (0..5, 0..5));
    }

    #[test]
    fn shards_are_read_and_what_is_none_is_refused() {
        assert_eq!("3/8".parse(), Ok(Shard { number: 3, count: 8 }));
        assert_eq!(Shard { number: 3, count: 8 }.to_string(), "3/8");
        for bad in
            ["0/8", "9/8", "1/0", "-1/8", "1", "1/", "/", "", "one/two", "1/1000001", "auto/0", "auto8", "auto/x"]
        {
            assert!(bad.parse::<ShardChoice>().is_err(), "{bad}");
        }
        assert_eq!("auto".parse(), Ok(ShardChoice::Auto(None)));
        assert_eq!("auto/8".parse(), Ok(ShardChoice::Auto(Some(8))));
    }

    #[test]
    fn schedulers_tell_the_shard() {
        let told = |choice: &str, variables: &[(&str, &str)]| {
            let variable = |name: &str| variables.iter().find(|it| it.0 == name).map(|it| it.1.to_owned());
            choice.parse::<ShardChoice>().unwrap().shard(&variable).map(|shard| shard.to_string())
        };
        let slurm = |id, count, min, max| {
            let names = ["ID", "COUNT", "MIN", "MAX"].map(|name| format!("SLURM_ARRAY_TASK_{name}"));
            let variables: Vec<_> = names.iter().map(String::as_str).zip([id, count, min, max]).collect();
            told("auto", &variables)
        };
        assert_eq!(slurm("1", "8", "1", "8"), Ok("1/8".into()));
        assert_eq!(slurm("0", "8", "0", "7"), Ok("1/8".into()));
        assert_eq!(slurm("12", "3", "10", "12"), Ok("3/3".into()));
        assert!(slurm("10", "5", "2", "10").unwrap_err().contains("must follow each other"));
        assert!(slurm("x", "5", "1", "5").unwrap_err().contains("SLURM_ARRAY_TASK_ID=x is no number"));
        assert_eq!(told("auto", &[("SLURM_ARRAY_TASK_ID", "2"), ("SLURM_ARRAY_TASK_COUNT", "2")]), Ok("2/2".into()));
        let other = told("auto/4", &[("SLURM_ARRAY_TASK_ID", "2"), ("SLURM_ARRAY_TASK_COUNT", "2")]);
        assert!(other.unwrap_err().contains("SLURM_ARRAY_TASK_COUNT=2"));
        for name in ["HQ_TASK_ID", "PARALLEL_SEQ"] {
            assert_eq!(told("auto/8", &[(name, "8")]), Ok("8/8".into()));
            assert!(told("auto", &[(name, "8")]).unwrap_err().contains("--shard auto/COUNT"), "{name}");
            assert!(told("auto/8", &[(name, "0")]).unwrap_err().contains("number the tasks from 1 on"), "{name}");
        }
        assert!(told("auto", &[]).unwrap_err().contains("--shard 1/8"));
        assert_eq!(told("2/3", &[("HQ_TASK_ID", "1")]), Ok("2/3".into()));
    }
}
