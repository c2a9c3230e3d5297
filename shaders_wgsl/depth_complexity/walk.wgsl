// How far an invocation may go.

// Mesa's software driver ends all loops of an invocation once they took 65,535 steps together, without a word. So walks are bounded, and
// those that were not finished are counted.
const LONGEST_WALK: u32 = 12000u;
