// The part of a pass's items that one dispatch works on. The engine fills it: long passes are split.

struct Slice {
    first: u32,
    count: u32,
}
