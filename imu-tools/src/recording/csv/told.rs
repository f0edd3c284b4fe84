//! What a table says of the unit of its columns.

/// What the names of columns, or a row of units, say of a unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Told<U> {
    /// Nothing.
    #[default]
    Nothing,
    /// This unit.
    Unit(U),
    /// A unit that nobody knows, or two of them: what is wrong, in words.
    Unclear(String),
}

impl<U: Copy + PartialEq> Told<U> {
    /// The unit given by the user, or else the one told.
    ///
    /// # Errors
    /// What is wrong with the one told, in words.
    pub fn unless(&self, given: Option<U>) -> Result<Option<U>, &str> {
        match (given, self) {
            (Some(given), _) => Ok(Some(given)),
            (None, Self::Nothing) => Ok(None),
            (None, Self::Unit(unit)) => Ok(Some(*unit)),
            (None, Self::Unclear(what)) => Err(what),
        }
    }

    /// Takes in what one column says, in words that `parse` knows; the first trouble stays.
    pub fn hear(
        &mut self,
        column: &[u8],
        unit: Option<&str>,
        parse: impl Fn(&str) -> Result<U, String>,
    ) {
        let unit = unit.unwrap_or_default().trim_matches(|c| "[]() ".contains(c));
        if unit.is_empty() || matches!(self, Self::Unclear(_)) {
            return;
        }
        let unclear =
            |what| Self::Unclear(format!("column '{}': {what}", String::from_utf8_lossy(column)));
        *self = match parse(unit) {
            Err(what) => unclear(what),
            Ok(unit) if matches!(self, Self::Unit(other) if *other != unit) => {
                unclear("its unit is not that of the sensor's other axes".into())
            }
            Ok(unit) => Self::Unit(unit),
        };
    }
}
