//! explore
use crate::decode::{Rule, TextError};
use crate::path::*;
use crate::rs274::*;
use std::path::Path;

#[test]
fn explore() {
    let shared = std::env::var_os("TWIN_SHARED")
        .map_or_else(|| Path::new("/work/shared").to_path_buf(), Into::into);
    let mut names = vec![];
    for l in std::fs::read_to_string(shared.join("corpus/INDEX.tsv")).unwrap().lines().skip(1) {
        let f: Vec<_> = l.split('\t').collect();
        names.push((format!("{}/{}", f[0], f[1]), f[3].to_owned()));
    }
    for (name, verdict) in names {
        let path = shared.join("corpus").join(&name);
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut els = vec![];
        let mut diags = vec![];
        let mut warns = vec![];
        for i in Decoder::new(file, DecoderOptions::default()) {
            match i {
                Ok(Item::Element(e)) => els.push(e),
                Ok(Item::Warning(d)) => warns.push(d),
                Err(Failure::Diagnostic(d)) => diags.push(d),
                Err(e) => panic!("{e}"),
            }
        }
        let stem = path.with_extension("moves.jsonl");
        let stem2 = Path::new(&format!("{}.moves.jsonl", path.display())).to_path_buf();
        let mtext =
            std::fs::read_to_string(&stem).or_else(|_| std::fs::read_to_string(&stem2)).unwrap();
        let moves: Vec<serde_json::Value> =
            mtext.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        let unsupported = diags.iter().find(|d| d.error.rule() == Rule::UnsupportedWord);
        let mine: Vec<_> = els
            .iter()
            .filter(|e| !matches!(e.kind, ElementKind::MFunction { .. } | ElementKind::Jump))
            .collect();
        let mut bad = None;
        for (i, (m, e)) in moves[..moves.len() - 1].iter().zip(&mine).enumerate() {
            let mut why = vec![];
            if m["line"].as_u64() != Some(u64::from(e.place.line)) {
                why.push(format!("line {}", e.place.line));
            }
            if let Some(end) = m["end"].as_array() {
                for (a, b) in end.iter().zip(e.end().coords.iter()) {
                    if (a.as_f64().unwrap() - b * 1e3).abs() > 1e-4 {
                        why.push(format!("end {:?}", e.end() * 1e3));
                    }
                }
            }
            let k = match (e.kind, &e.shape) {
                (ElementKind::Rapid, _) => "rapid",
                (ElementKind::Cut, Shape::Line { .. }) => "feed",
                (ElementKind::Cut, Shape::Arc(_)) => "arc",
                (ElementKind::Dwell { .. }, _) => "dwell",
                _ => "?",
            };
            if m["kind"] != k {
                why.push(format!("kind {k}"));
            }
            if let Some(f) = m["feed"].as_f64() {
                if (f - e.feed * 6e4).abs() > 1e-3 * 1f64.max(f * 1e-6) {
                    why.push(format!("feed {}", e.feed * 6e4));
                }
            }
            if let Shape::Arc(a) = &e.shape {
                let [c1, c2, _] = a.plane().split(&a.center().coords);
                let c = m["center"].as_array().unwrap();
                let (c1, c2) = (c1 * 1e3, c2 * 1e3);
                if (c[0].as_f64().unwrap() - c1).abs() > 1e-4
                    || (c[1].as_f64().unwrap() - c2).abs() > 1e-4
                {
                    why.push(format!("center {c1} {c2}"));
                }
                let t = m["turns"].as_f64().unwrap();
                let mt =
                    (a.sweep().abs() / std::f64::consts::TAU - 1e-9).ceil() * a.sweep().signum();
                if t != mt {
                    why.push(format!("turns {mt}"));
                }
            }
            if !why.is_empty() {
                bad = Some((i, m.to_string(), why));
                break;
            }
        }
        println!(
            "{name}: {} ours {} oracle {} | verdict {verdict}",
            if unsupported.is_some() { "OUT" } else { "IN" },
            mine.len(),
            moves.len() - 1
        );
        if let Some(u) = unsupported {
            println!("     first unsupported {u}");
        }
        if let Some(b) = bad {
            println!("     DIFF {b:?}");
        }
        for d in diags.iter().filter(|d| d.error.rule() != Rule::UnsupportedWord).take(3) {
            println!("     error {d}");
        }
        for d in warns.iter().take(2) {
            println!("     warn {d}");
        }
    }
}
