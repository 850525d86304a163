//! Memory as a few objects that do not overlap, each a set of fields.

use std::collections::BTreeMap;

use super::Value;
use crate::ir::Type;

/// How a field is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldType {
    /// An f32.
    Float,
    /// An integer of this many bits.
    Int(u32),
    /// A truth value in a byte.
    Bool,
    /// A pointer to the object of this name.
    Pointer(&'static str),
}

impl FieldType {
    /// As the code loads it.
    pub const fn in_memory(self) -> Type {
        match self {
            Self::Float => Type::Float,
            Self::Int(bits) => Type::Int(bits),
            Self::Bool => Type::Int(8),
            Self::Pointer(_) => Type::Ptr,
        }
    }
}

/// A scalar within an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name in the specification.
    pub name: String,
    /// Where it begins \[bytes\].
    pub offset: usize,
    /// What it is.
    pub ty: FieldType,
}

/// What a pointer argument points to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Object {
    /// The name of the parameter, which the specification uses too.
    pub name: String,
    /// Its fields.
    pub fields: Vec<Field>,
    /// Whether the fields have values on entry; else they are only written.
    pub readable: bool,
}

/// The present contents of all objects, by offset.
#[derive(Default)]
pub(super) struct Memory {
    objects: Vec<BTreeMap<usize, Value>>,
}

fn size(value: &Value) -> usize {
    match value {
        Value::Bool(_) => 1,
        Value::Bits(bits, _) => bits.div_ceil(8) as usize,
        Value::Float(_) | Value::Address(_) => 4,
    }
}

impl Memory {
    pub(super) fn add(&mut self) -> usize {
        self.objects.push(BTreeMap::new());
        self.objects.len() - 1
    }

    /// What a load sees: a field, whole, as it was stored.
    pub(super) fn load(&self, address: (usize, usize), ty: Type) -> Result<Value, String> {
        let (object, offset) = address;
        let value = self.objects[object].get(&offset);
        let value = value.ok_or_else(|| format!("a load of no known field at byte {offset}"))?;
        if value.is(ty) || ty.bytes() == Some(size(value)) {
            Ok(value.clone())
        } else {
            Err(format!("a load of another size at byte {offset}"))
        }
    }

    /// Replaces a field; where none is known yet, whatever else lies there would be torn.
    pub(super) fn store(&mut self, address: (usize, usize), value: Value) -> Result<(), String> {
        let (object, offset) = address;
        let fields = &mut self.objects[object];
        let end = offset + size(&value);
        let torn = fields
            .range(..end)
            .any(|(&at, old)| at + size(old) > offset && (at, size(old)) != (offset, size(&value)));
        if torn {
            return Err(format!("a store over parts of fields at byte {offset}"));
        }
        fields.insert(offset, value);
        Ok(())
    }
}
