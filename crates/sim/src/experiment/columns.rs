//! Trials as a table of columns.
//!
//! # Source
//! [Parquet]: one row group, optional columns, Snappy. Columns: `experiment`, `world`, `seed`; one a factor; one a value.
//!
//! # Deviations
//! Which columns are factors stands in the file's metadata under `cohaul.factors`, as a JSON list: without it a table would
//! not say what is a level and what was measured.
//!
//! [Parquet]: cohaul_core::_documentation::references

use std::collections::BTreeSet;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::Field;
use parquet::schema::types::Type;

use super::trials::{Key, Level, Trial, TrialError, Value};
use crate::mission::VERSION;

/// Under which the names of the factors stand in the metadata.
const FACTORS: &str = "cohaul.factors";
/// The columns that every table begins with.
const FIXED: [&str; 3] = ["experiment", "world", "seed"];

impl From<ParquetError> for TrialError {
    fn from(error: ParquetError) -> Self {
        Self::Table(error.to_string())
    }
}

/// A column of one type, with its holes.
enum Column {
    Boolean(Vec<Option<bool>>),
    Integer(Vec<Option<i64>>),
    /// Bits of unsigned integers.
    Unsigned(Vec<Option<i64>>),
    Number(Vec<Option<f64>>),
    Text(Vec<Option<String>>),
}

impl Column {
    /// The narrowest type that holds every value: mixed with anything but integers, numbers become text.
    fn of_values(values: &[Option<&Value>]) -> Self {
        let all = |fits: fn(&Value) -> bool| values.iter().flatten().all(|value| fits(value));
        if all(|value| matches!(value, Value::Boolean(_))) {
            Self::Boolean(values.iter().map(|v| v.map(|value| *value == Value::Boolean(true))).collect())
        } else if all(|value| matches!(value, Value::Integer(_))) {
            let integer = |value: &Value| match value {
                Value::Integer(integer) => Some(*integer),
                _ => None,
            };
            Self::Integer(values.iter().map(|value| value.and_then(integer)).collect())
        } else if all(|value| value.number().is_some()) {
            Self::Number(values.iter().map(|value| value.and_then(Value::number)).collect())
        } else {
            Self::Text(values.iter().map(|value| value.map(ToString::to_string)).collect())
        }
    }

    fn of_levels(levels: &[Option<&Level>]) -> Self {
        let number = |level: &Level| match level {
            Level::Number(number) => Some(*number),
            Level::Text(_) => None,
        };
        if levels.iter().flatten().all(|level| number(level).is_some()) {
            Self::Number(levels.iter().map(|level| level.and_then(number)).collect())
        } else {
            Self::Text(levels.iter().map(|level| level.map(ToString::to_string)).collect())
        }
    }

    fn schema(&self, name: &str) -> Result<Type, ParquetError> {
        let (physical, logical) = match self {
            Self::Boolean(_) => (Physical::BOOLEAN, None),
            Self::Integer(_) => (Physical::INT64, None),
            Self::Unsigned(_) => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Self::Number(_) => (Physical::DOUBLE, None),
            Self::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()
    }

    fn write<W: std::io::Write + Send>(&self, group: &mut SerializedRowGroupWriter<'_, W>) -> Result<(), TrialError> {
        let missing = || TrialError::Table("fewer columns than planned".to_owned());
        let mut column = group.next_column()?.ok_or_else(missing)?;
        match (self, column.untyped()) {
            (Self::Boolean(values), ColumnWriter::BoolColumnWriter(writer)) => {
                writer.write_batch(&filled(values), Some(&present(values)), None)?;
            }
            (Self::Integer(values) | Self::Unsigned(values), ColumnWriter::Int64ColumnWriter(writer)) => {
                writer.write_batch(&filled(values), Some(&present(values)), None)?;
            }
            (Self::Number(values), ColumnWriter::DoubleColumnWriter(writer)) => {
                writer.write_batch(&filled(values), Some(&present(values)), None)?;
            }
            (Self::Text(values), ColumnWriter::ByteArrayColumnWriter(writer)) => {
                let texts: Vec<ByteArray> = values.iter().flatten().map(|text| text.as_str().into()).collect();
                writer.write_batch(&texts, Some(&present(values)), None)?;
            }
            _ => return Err(TrialError::Table("a column is of another type than planned".to_owned())),
        }
        column.close()?;
        Ok(())
    }
}

fn filled<T: Copy>(values: &[Option<T>]) -> Vec<T> {
    values.iter().flatten().copied().collect()
}

/// Definition levels: 1 where there is a value.
fn present<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|value| i16::from(value.is_some())).collect()
}

/// The bytes of a Parquet file of these trials, sorted by cell and seed.
///
/// # Errors
/// A factor with the name of a value or of a fixed column.
pub(super) fn encode(trials: &[Trial]) -> Result<Vec<u8>, TrialError> {
    let mut sorted: Vec<&Trial> = trials.iter().collect();
    sorted.sort_by(|a, b| (&a.key, a.seed, &a.experiment, &a.world).cmp(&(&b.key, b.seed, &b.experiment, &b.world)));
    let text = |of: fn(&Trial) -> &String| Column::Text(sorted.iter().map(|trial| Some(of(trial).clone())).collect());
    let mut columns: Vec<(&str, Column)> = vec![
        ("experiment", text(|trial| &trial.experiment)),
        ("world", text(|trial| &trial.world)),
        ("seed", Column::Unsigned(sorted.iter().map(|trial| Some(trial.seed.cast_signed())).collect())),
    ];
    let factors = in_order(sorted.iter().flat_map(|trial| trial.key.iter().map(|(name, _)| name)));
    for factor in &factors {
        let levels: Vec<Option<&Level>> = sorted.iter().map(|trial| trial.key.level(factor)).collect();
        columns.push((factor, Column::of_levels(&levels)));
    }
    for name in in_order(sorted.iter().flat_map(|trial| trial.values().map(|(name, _)| name))) {
        let values: Vec<Option<&Value>> = sorted.iter().map(|trial| trial.value(name)).collect();
        columns.push((name, Column::of_values(&values)));
    }
    let mut names = BTreeSet::new();
    if let Some((twice, _)) = columns.iter().find(|(name, _)| !names.insert(*name)) {
        return Err(TrialError::Column { name: (*twice).to_owned() });
    }
    let fields = columns.iter().map(|(name, column)| column.schema(name).map(Arc::new)).collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("trials").with_fields(fields).build()?;
    let list = serde_json::to_string(&factors).map_err(TrialError::Fields)?;
    let properties = WriterProperties::builder()
        .set_created_by(format!("cohaul version {VERSION}"))
        .set_compression(Compression::SNAPPY)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(vec![KeyValue::new(FACTORS.to_owned(), list)]))
        .build();
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for (_, column) in &columns {
        column.write(&mut group)?;
    }
    group.close()?;
    file.close()?;
    Ok(bytes)
}

/// Each name once, in order of first appearance.
fn in_order<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    names.filter(|name| seen.insert(*name)).collect()
}

/// The trials of a Parquet file.
///
/// # Errors
/// Another file, or another table.
pub(super) fn decode<R: ChunkReader + 'static>(input: R) -> Result<Vec<Trial>, TrialError> {
    let reader = SerializedFileReader::new(input)?;
    let factors = reader
        .metadata()
        .file_metadata()
        .key_value_metadata()
        .and_then(|list| list.iter().find(|entry| entry.key == FACTORS)?.value.as_deref())
        .ok_or_else(|| TrialError::Table(format!("not one of trials: its metadata has no {FACTORS}")))?;
    let factors: BTreeSet<String> = serde_json::from_str(factors).map_err(TrialError::Fields)?;
    reader.get_row_iter(None)?.map(|row| trial(row?.into_columns(), &factors)).collect()
}

fn trial(row: Vec<(String, Field)>, factors: &BTreeSet<String>) -> Result<Trial, TrialError> {
    let mut trial = Trial::new("", "", Key::new(), 0);
    let mut fixed = BTreeSet::new();
    for (name, field) in row {
        let strange = |field: &Field| TrialError::Table(format!("column {name:?} cannot hold {field}"));
        match (name.as_str(), field) {
            ("experiment", Field::Str(text)) => trial.experiment = text,
            ("world", Field::Str(text)) => trial.world = text,
            ("seed", Field::ULong(seed)) => trial.seed = seed,
            (factor, field) if factors.contains(factor) => match field {
                Field::Null => {}
                Field::Double(number) => trial.key = trial.key.with(factor, number),
                Field::Str(text) => trial.key = trial.key.with(factor, text),
                other => return Err(strange(&other)),
            },
            (_, Field::Null) => {}
            (name, Field::Bool(truth)) => trial.push(name, truth),
            (name, Field::Long(integer)) => trial.push(name, integer),
            (name, Field::Double(number)) => trial.push(name, number),
            (name, Field::Str(text)) => trial.push(name, text),
            (_, other) => return Err(strange(&other)),
        }
        if FIXED.contains(&name.as_str()) {
            fixed.insert(name);
        }
    }
    match FIXED.iter().find(|name| !fixed.contains(**name)) {
        Some(name) => Err(TrialError::Table(format!("column {name:?} is missing"))),
        None => Ok(trial),
    }
}
