//! What a PLY file says it holds.

/// The most elements, and the most properties of one: each is compared with those before it.
const MAX_NAMES: usize = 1 << 10;

/// How the rows are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Types of numbers, under their old and new names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { length: Scalar, item: Scalar },
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// Rows of one kind.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) rows: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// The header, and the bytes that follow it.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        let (mut rest, mut encoding, mut elements) = (bytes, None, Vec::<Element>::new());
        for number in 1_usize.. {
            let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
                return Err("its header has no 'end_header'; it is truncated or no PLY file".into());
            };
            let (line, behind) = rest.split_at(end);
            rest = behind.split_at(1).1;
            // Only comments can be anything but ASCII.
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_whitespace().collect();
            let broken = |reason: &str| format!("header line {number}: {reason}");
            match (words[..].split_first(), number) {
                (Some((&"ply", [])), 1) => {}
                (_, 1) => return Err("it does not begin with 'ply'".into()),
                (None, _) | (Some((&("comment" | "obj_info"), _)), _) => {}
                (Some((&"format", rest)), _) => encoding = Some(read_encoding(rest).map_err(|r| broken(&r))?),
                (Some((&"element", [name, rows])), _) => {
                    let rows = rows.parse().map_err(|_| broken(&format!("'{rows:.40}' is not a number of rows")))?;
                    if elements.iter().any(|e| e.name == *name) {
                        return Err(broken(&format!("a second element '{name:.40}'")));
                    }
                    if elements.len() == MAX_NAMES {
                        return Err(broken(&format!("more than {MAX_NAMES} elements")));
                    }
                    elements.push(Element { name: (*name).into(), rows, properties: Vec::new() });
                }
                (Some((&"property", rest)), _) => {
                    let element = elements.last_mut().ok_or_else(|| broken("a property before the first element"))?;
                    let property = read_property(rest).map_err(|r| broken(&r))?;
                    if element.properties.iter().any(|p| p.name == property.name) {
                        return Err(broken(&format!("a second property '{:.40}'", property.name)));
                    }
                    if element.properties.len() == MAX_NAMES {
                        return Err(broken(&format!("more than {MAX_NAMES} properties")));
                    }
                    element.properties.push(property);
                }
                (Some((&"end_header", [])), _) => {
                    let encoding = encoding.ok_or("its header has no 'format'")?;
                    return Ok((Self { encoding, elements }, rest));
                }
                (Some((word, _)), _) => return Err(broken(&format!("'{word:.40}' is unknown or incomplete"))),
            }
        }
        Err("its header does not end".into())
    }
}

fn read_encoding(words: &[&str]) -> Result<Encoding, String> {
    match words {
        ["ascii", "1.0"] => Ok(Encoding::Text),
        ["binary_little_endian", "1.0"] => Ok(Encoding::LittleEndian),
        ["binary_big_endian", "1.0"] => Ok(Encoding::BigEndian),
        _ => Err(format!("format '{:.40}' is unknown", words.join(" "))),
    }
}

fn read_property(words: &[&str]) -> Result<Property, String> {
    let (kind, name) = match words {
        ["list", length, item, name] => (Kind::List { length: Scalar::of(length)?, item: Scalar::of(item)? }, name),
        [scalar, name] => (Kind::Scalar(Scalar::of(scalar)?), name),
        _ => return Err("a property needs a type and a name".into()),
    };
    if matches!(kind, Kind::List { length: Scalar::F32 | Scalar::F64, .. }) {
        return Err("the length of a list must be a whole number".into());
    }
    Ok(Property { name: (*name).into(), kind })
}

impl Scalar {
    fn of(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(format!("type '{name:.40}' is unknown")),
        })
    }

    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}
