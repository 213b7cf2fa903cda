//! A reader for the part of Python's pickle format that saved numpy arrays use.
//!
//! Runs nothing: a global is a name and a call is a record of its arguments. Objects live in one list and refer to each
//! other by index, so that no file can make it recurse.

/// Index of an object.
pub type Id = usize;

/// An object of a pickle.
#[derive(Clone, Debug, PartialEq)]
pub enum Object {
    /// None, and things that don't matter here.
    None,
    /// A boolean.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A real number.
    Float(f64),
    /// Text.
    Text(String),
    /// Bytes.
    Bytes(Vec<u8>),
    /// A list or tuple.
    Sequence(Vec<Id>),
    /// A dictionary, in order.
    Dict(Vec<(Id, Id)>),
    /// A module and a name in it.
    Global(String),
    /// A call: what, arguments, state set afterwards, items put in.
    Call {
        /// What was called.
        what: Id,
        /// With which arguments.
        arguments: Id,
        /// State set afterwards.
        state: Option<Id>,
        /// Items put in afterwards.
        items: Vec<(Id, Id)>,
    },
}

/// All objects of a pickle.
#[derive(Clone, Debug, PartialEq)]
pub struct Pickle {
    objects: Vec<Object>,
    root: Id,
}

impl Pickle {
    /// Reads a pickle.
    ///
    /// # Errors
    /// Says what was expected and found, and where.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let (objects, root) = super::pickle_machine::read(bytes)?;
        Ok(Self { objects, root })
    }

    /// The outermost object.
    #[must_use]
    pub fn root(&self) -> Id {
        self.root
    }

    /// The object of an index.
    #[must_use]
    pub fn object(&self, id: Id) -> &Object {
        // Ids come from the machine, which gives them to objects only.
        &self.objects[id]
    }

    /// The value of a key in a dictionary, or in a call that builds one.
    #[must_use]
    pub fn item(&self, dict: Id, key: &str) -> Option<Id> {
        let items = match self.object(dict) {
            Object::Dict(items) | Object::Call { items, .. } => items,
            _ => return None,
        };
        items.iter().find(|(k, _)| matches!(self.object(*k), Object::Text(t) if t == key)).map(|(_, v)| *v)
    }
}
