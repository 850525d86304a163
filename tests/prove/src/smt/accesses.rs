//! Loads, stores and fences, also at addresses that depend on data.

use std::collections::BTreeMap;

use super::translate::State;
use super::{Address, Value, bits};
use crate::ir::{Instruction, Op, Operand, Type};

/// So many words an address may be moved at most.
const MOST_WORDS: usize = 8;

/// Terms that count stores \[16 bits\], by object and offset.
pub(super) type Counts = BTreeMap<(usize, usize), String>;

impl State {
    fn address(&self, operand: &Operand) -> Result<Address, String> {
        match self.value(Type::Ptr, operand)? {
            Value::Address(address) => Ok(address),
            _ => Err("no address".to_owned()),
        }
    }

    pub(super) fn offset(&self, base: &Operand, bytes: i128) -> Result<Value, String> {
        let mut address = self.address(base)?;
        let offset = address.offset as i128 + bytes;
        address.offset = usize::try_from(offset).map_err(|_| "offset")?;
        Ok(Value::Address(address))
    }

    /// Keeps in mind how large a value can be that is masked by a constant.
    pub(super) fn note_most(&mut self, name: &str, op: &Op) {
        if let Op::IntBinary(op, _, _, _, Operand::Int(mask)) = op
            && op == "and"
            && let Ok(mask) = usize::try_from(*mask)
        {
            self.most.insert(name.to_owned(), mask);
        }
    }

    /// An address a number of words further, of which it must be known how many there can be.
    pub(super) fn words(
        &self,
        base: &Operand,
        ty: Type,
        number: &Operand,
    ) -> Result<Value, String> {
        let mut address = self.address(base)?;
        let most = match number {
            Operand::Local(name) => self.most.get(name),
            _ => None,
        };
        match (&address.words, most) {
            (None, Some(&most)) if most < MOST_WORDS => {
                address.words = Some((self.term(ty, number)?, most));
                Ok(Value::Address(address))
            }
            _ => Err("an address that depends on data".to_owned()),
        }
    }

    /// What an address may point to, with terms of which just one is true.
    fn reached(address: &Address) -> Vec<((usize, usize), String)> {
        let Some((words, most)) = &address.words else {
            return vec![((address.object, address.offset), "true".to_owned())];
        };
        let equal = |number: usize| format!("(= {words} {})", bits(32, number as i128));
        let others: Vec<String> = (0..*most).map(equal).collect();
        (0..=*most)
            .map(|number| {
                let term = if number < *most {
                    equal(number)
                } else {
                    format!("(not (or false {}))", others.join(" "))
                };
                ((address.object, address.offset + 4 * number), term)
            })
            .collect()
    }

    pub(super) fn load(&mut self, ty: Type, pointer: &Operand) -> Result<Value, String> {
        let address = self.address(pointer)?;
        let mut loaded: Option<Value> = None;
        for (at, condition) in Self::reached(&address) {
            let value = self.memory.load(at, ty)?;
            let value = self.reinterpret(value, ty)?;
            loaded = Some(match loaded {
                None => value,
                Some(others) => choice(&condition, &value, &others)?,
            });
        }
        loaded.ok_or_else(|| "a load of nothing".to_owned())
    }

    /// A store happens only if its block is reached, and there only where the address points to.
    pub(super) fn store(
        &mut self,
        ty: Type,
        value: &Operand,
        pointer: &Operand,
    ) -> Result<(), String> {
        let (value, address) = (self.value(ty, value)?, self.address(pointer)?);
        for (at, condition) in Self::reached(&address) {
            let conditions = [self.here.clone(), condition];
            let conditions: Vec<&str> = conditions.iter().map(String::as_str).collect();
            let condition = super::translate::and(&conditions);
            self.count_store(at, &condition)?;
            let value = if condition == "true" {
                value.clone()
            } else {
                let old = self.memory.load(at, ty)?;
                let old = self.reinterpret(old, ty)?;
                let value = choice(&condition, &value, &old)?;
                self.define(&value)
            };
            self.memory.store(at, value)?;
        }
        Ok(())
    }

    fn count_store(&mut self, at: (usize, usize), condition: &str) -> Result<(), String> {
        let number = usize::from(self.is_released);
        let Some(old) = self.count_of(number, at) else {
            return Ok(());
        };
        let old = old.term().ok_or("a count")?;
        let one = format!("(ite {condition} {} {})", bits(16, 1), bits(16, 0));
        let count = self.define(&Value::Bits(16, format!("(bvadd {old} {one})")));
        if let (Some(stores), Some(term)) = (&mut self.stores, count.term()) {
            stores[number].insert(at, term.to_owned());
        }
        Ok(())
    }

    /// How often a field is stored before the release fence (0) or after it (1), if there is one.
    pub(super) fn count_of(&self, number: usize, at: (usize, usize)) -> Option<Value> {
        let count = self.stores.as_ref()?[number].get(&at);
        Some(Value::Bits(
            16,
            count.cloned().unwrap_or_else(|| bits(16, 0)),
        ))
    }

    /// The compiler moves no access over a fence, nor does this; but it tells the stores before a
    /// release fence from those after it. There may be one, which is always reached.
    pub(super) fn fence(
        &mut self,
        instruction: &Instruction,
        is_release: bool,
    ) -> Result<(), String> {
        if is_release {
            if self.is_released {
                return Err("a second release fence".to_owned());
            }
            self.is_released = true;
            let line = instruction.line.trim().to_owned();
            self.out.demands.push((line, self.here.clone()));
        }
        Ok(())
    }
}

fn choice(condition: &str, yes: &Value, no: &Value) -> Result<Value, String> {
    let (yes_term, no_term) = (
        yes.term().ok_or("an address")?,
        no.term().ok_or("an address")?,
    );
    Ok(yes.named(format!("(ite {condition} {yes_term} {no_term})")))
}
