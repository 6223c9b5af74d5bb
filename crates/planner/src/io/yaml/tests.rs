use std::fmt::Write as _;

use super::*;

fn shown(node: Node<'_>, text: &mut String) {
    match node.raw().kind {
        Kind::Null => text.push('~'),
        Kind::Plain => text.push_str(&node.number("").map_or_else(|_| node.scalar().to_owned(), |n| n.to_string())),
        Kind::Quoted => text.push_str(node.scalar()),
        Kind::List => {
            text.push('[');
            node.children().for_each(|child| {
                shown(child, text);
                text.push(',');
            });
            text.push(']');
        }
        Kind::Map => {
            text.push('{');
            node.entries("").unwrap().for_each(|(_, key, value)| {
                let _ = write!(text, "{key}:");
                shown(value, text);
                text.push(',');
            });
            text.push('}');
        }
    }
}

/// As read here and by the library; nothing where it is refused.
fn both(text: &str) -> (Option<String>, Option<String>) {
    let show = |nodes, copied| {
        let tree = Tree { name: "", text, copied, nodes };
        let mut shown_text = String::new();
        shown(tree.root(), &mut shown_text);
        shown_text
    };
    let here = plain::read(text).ok().map(|nodes| show(nodes, String::new()));
    let library = library::read("", text).ok().map(|(nodes, copied)| show(nodes, copied));
    (here, library)
}

#[test]
fn what_is_read_here_is_what_the_library_reads() {
    let texts = [
        "",
        "# nothing\n",
        "a: 1",
        "a: 1 # one\nb:\n- 2\n-   c: 3\n    d: [4, {e: 5}, 'six', \"7\"]\n- - 8\n  - 9\n-\n  - x\nf:\n  g: null\n  h:\nlast:",
        "a:\r\n  - 1\r\n  - [2,\r\n     3]\r\n",
        "- 1\n- ~\n-\n- {}\n- []\n- [1, 2, ]\n- a b c\n",
        "a: {b: , c: 1}\nd: -0.5\ne: -1e-3\nf: +4",
        "obstacles: \n    - [-1, -1]\n",
    ];
    for text in texts {
        let (here, library) = both(text);
        assert!(here.is_some(), "{text}");
        assert_eq!(here, library, "{text}");
    }
}

#[test]
fn what_is_not_known_for_certain_is_refused() {
    let texts = [
        "a: &x 1",
        "a: *x",
        "a: !t 1",
        "a: |\n  x",
        "a: >\n  x",
        "? a",
        "---\na: 1",
        "a: 1\n---\nb: 2",
        "a: 1\n b: 2",
        "a: b: c",
        "a: - 1",
        "a: 'it''s'",
        "a: \"\\n\"",
        "a: x\n  y",
        "a: [1\n, 2]",
        "a:\t1",
        "a: [1 2]",
        "a: [1, , 2]",
        "a: {b}",
        "a: [b: 1]",
        "a: {b:1}",
        "ä: 1",
        "a: ö",
        "a: 1\n- 2",
        "- 1\na: 2",
        "a: [",
        "a: 'x",
        "%YAML 1.2\n",
        "a: @x",
        "a: [1] 2",
        "a: x:",
        "[a]: 1",
        "a: 1#2",
        "- 1\n  - 2",
    ];
    for text in texts {
        assert_eq!(both(text).0, None, "{text}");
    }
}

/// 20,000 mutations of two files (seeds 0 to 19,999): what is read here is read by the library, as the same.
#[test]
fn mutations_are_read_as_the_library_reads_them() {
    let files = [
        "agents:\n-   goal: [3, 1]\n    name: agent0\n    start: [0, 3]\n- name: b\n  potentialGoals: [[1, 2],\n   [2, 3]]\nmap:\n    dimensions: [8, 4]\n    obstacles: # none\n    - [5, 3]\n",
        "statistics:\n  cost: 3.5\nschedule:\n  a:\n    - x: 0\n      y: 1\n      t: 0\n  b: [{x: 0, y: -1.5, t: 0}, {x: 1, t: 1}]\n",
    ];
    let pieces = [
        "-", ":", " ", "\n", "[", "]", "{", "}", ",", "#", "'", "\"", "  ", "- ", ": ", "a", "1", ".", "~", "e", "\r\n",
    ];
    let mut read = 0;
    for seed in 0..20_000_u64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut draw = |below: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 20) as usize % below
        };
        draw(2);
        let mut text = files[draw(2)].to_owned();
        for _ in 0..1 + draw(3) {
            let at = draw(text.len() + 1);
            if draw(3) == 0 {
                let end = (at + 1 + draw(6)).min(text.len());
                text.replace_range(at..end, "");
            } else {
                text.insert_str(at, pieces[draw(pieces.len())]);
            }
        }
        let (here, library) = both(&text);
        if here.is_some() {
            read += 1;
            // a key twice is refused by the library, and by whoever asks for the fields here
            assert!(library.is_none() || here == library, "seed {seed}\n{text}\n{here:?}\n{library:?}");
            if library.is_none() {
                let error = library::read("", &text).map(|_| ()).unwrap_err().to_string();
                assert!(error.contains("duplicate"), "seed {seed}\n{text}\n{error}");
            }
        }
    }
    assert!(read > 1_500, "only {read} were read");
}
