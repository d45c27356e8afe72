//! The seal of a part's results: a hash by which damage is known when parts are joined.

use super::Results;
use crate::HarnessError;

impl Results {
    /// Notes the hash of a part's results in them.
    pub(crate) fn seal(&mut self) -> Result<(), HarnessError> {
        let blake3 = self.unsealed_hash()?;
        if let Some(facts) = &mut self.part {
            facts.blake3 = blake3;
        }
        Ok(())
    }

    /// Whether they are what was sealed.
    pub(crate) fn is_sealed(&self) -> Result<bool, HarnessError> {
        Ok(self.part.as_ref().map(|facts| &facts.blake3) == Some(&self.unsealed_hash()?))
    }

    fn unsealed_hash(&self) -> Result<String, HarnessError> {
        let mut unsealed = self.clone();
        if let Some(facts) = &mut unsealed.part {
            facts.blake3.clear();
        }
        Ok(blake3::hash(unsealed.to_json()?.as_bytes()).to_hex().to_string())
    }
}
