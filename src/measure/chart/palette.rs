//! Colours and marks. Okabe and Ito's colours (2008), which the colour-blind tell apart; families differ in their mark,
//! and lines of one family in their dashes, so that no reading hangs on colour alone.

/// The style of every chart. Class `fN` colours a family, `sN` a part of a stack; `hit` is not seen, but tells what it is when
/// pointed at. What only stands beside marks lets the pointer through to them.
pub const STYLE: &str = "\
text{font-family:sans-serif;font-size:13px;fill:#222}
.title{font-size:17px}.note{font-size:12px;fill:#555}.tick{font-size:12px;fill:#444}
.paper{fill:#fff}.frame{fill:none;stroke:#777}.grid{stroke:#ddd;stroke-width:1}.faintgrid{stroke:#eee}
.band{fill:#eef3ee}.axis{stroke:#777}.leader{stroke:#999;stroke-width:0.8;stroke-dasharray:1 3}
.f0{fill:#000;stroke:#000}.f1{fill:#0072b2;stroke:#0072b2}.f2{fill:#009e73;stroke:#009e73}.f3{fill:#e69f00;stroke:#e69f00}
.f4{fill:#d55e00;stroke:#d55e00}.f5{fill:#cc79a7;stroke:#cc79a7}.f6{fill:#56b4e9;stroke:#56b4e9}
.s0{fill:#440154}.s1{fill:#443983}.s2{fill:#31688e}.s3{fill:#21918c}.s4{fill:#35b779}.s5{fill:#90d743}.s6{fill:#fde725}.s7{fill:#bbb}
.part{stroke:#fff;stroke-width:0.7}.line{fill:none;stroke-width:2}.front{fill:none;stroke:#777;stroke-width:1.5;stroke-dasharray:5 3}
.whisker{stroke-width:1.3}.faint{opacity:0.35}
.whisker,.leader,.line,.front,text{pointer-events:none}.point text{pointer-events:auto}.hit{fill:none;pointer-events:all}";

/// What changes on a dark page.
pub const DARK: &str = "\
text{fill:#ddd}.note,.tick{fill:#aaa}.paper{fill:#16181c}.frame,.axis{stroke:#888}.grid{stroke:#33363c}.faintgrid{stroke:#25282d}
.band{fill:#1d2a22}.f0{fill:#fff;stroke:#fff}.f1{fill:#3a9bdc;stroke:#3a9bdc}.front{stroke:#999}.part{stroke:#16181c}
.s0{fill:#6b2a86}.s1{fill:#5d55b0}.faint{opacity:0.55}";

/// A family of methods: its name in records, the class of its colour, and its mark within 10 x 10 pixels.
struct Family {
    name: &'static str,
    class: &'static str,
    mark: &'static str,
}

const FAMILIES: &[Family] = &[
    Family { name: "full", class: "f0", mark: "M-4.5-4.5h9v9h-9z" },
    Family { name: "exact", class: "f1", mark: "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z" },
    Family { name: "balanced", class: "f2", mark: "M0-6L6 0L0 6L-6 0z" },
    Family { name: "hit", class: "f3", mark: "M0-5.5L5.5 4.5H-5.5z" },
    Family { name: "color", class: "f4", mark: "M0 5.5L5.5-4.5H-5.5z" },
    Family { name: "fast", class: "f5", mark: "M0-6.5L1.5-2L6-2L2.5 1L4 5.5L0 2.8L-4 5.5L-2.5 1L-6-2L-1.5-2z" },
    Family {
        name: "difference cache",
        class: "f6",
        mark: "M-1.8-5.5h3.6v3.7h3.7v3.6h-3.7v3.7h-3.6v-3.7h-3.7v-3.6h3.7z",
    },
];

fn family(name: &str) -> &'static Family {
    FAMILIES.iter().find(|family| family.name == name).unwrap_or(&FAMILIES[0])
}

/// The class of a family's colour.
pub fn class(name: &str) -> &'static str {
    family(name).class
}

/// A family's mark, a path around (0, 0).
pub fn mark(name: &str) -> &'static str {
    family(name).mark
}

/// Dashes for the lines of one family, in the order of its methods.
pub const DASHES: [&str; 5] = ["none", "7 3", "2 3", "9 3 2 3", "4 2"];
