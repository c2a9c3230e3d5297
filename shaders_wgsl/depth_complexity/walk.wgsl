// How far an invocation may go.

// Mesa's software driver ends all loops of an invocation once they took 65,535 steps together, without a word. So walks are bounded, and
// those that were not finished are counted.
const LONGEST_WALK: u32 = 12000u;

// A list that takes more steps than this is given up, and counted.
const MOST_STEPS: u32 = 60000u;

// How the steps are shared among the lanes of a vector is the driver's affair. So every kernel with long loops ends with one of this
// many steps: where that is cut short, so may be what came before.
const LAST_STEPS: u32 = 8u;

// Software drivers give each thread a run of workgroups, and the costly ones lie side by side. So groups take blocks of work in strides:
// of as many blocks, rounded up to whole strides, group `g` takes this one, or none where there are fewer.
const STRIDES: u32 = 32u;

fn scattered(g: u32, blocks: u32) -> u32 {
    let rows = max((blocks + STRIDES - 1u) / STRIDES, 1u);
    return (g % rows) * STRIDES + g / rows;
}
