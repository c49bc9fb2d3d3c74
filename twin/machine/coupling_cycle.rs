//! Coupling cycles: axes that follow each other in a circle.

use std::collections::VecDeque;

/// Finds a cycle among `couplings` (master, slave): from the axis with the least number in a cycle back to it.
pub fn find(couplings: &[(usize, usize)]) -> Option<Vec<usize>> {
    let mut axes: Vec<_> = couplings.iter().map(|(master, _)| *master).collect();
    axes.sort_unstable();
    axes.dedup();
    axes.into_iter().find_map(|axis| back_to(axis, couplings))
}

/// The shortest way from an axis by way of its slaves back to itself.
fn back_to(axis: usize, couplings: &[(usize, usize)]) -> Option<Vec<usize>> {
    let mut seen = vec![axis];
    let mut ways = VecDeque::from([vec![axis]]);
    while let Some(way) = ways.pop_front() {
        let last = way.last().copied()?;
        for (_, slave) in couplings.iter().filter(|(master, _)| *master == last) {
            let mut further = way.clone();
            further.push(*slave);
            if *slave == axis {
                return Some(further);
            }
            if !seen.contains(slave) {
                seen.push(*slave);
                ways.push_back(further);
            }
        }
    }
    None
}

/// Message of a cycle: `X -> Y -> X`.
pub fn message<'n>(cycle: &[usize], name: impl Fn(usize) -> &'n str) -> String {
    cycle.iter().map(|axis| name(*axis)).collect::<Vec<_>>().join(" -> ")
}

#[cfg(test)]
mod tests {
    use super::{find, message};

    #[test]
    fn cycles_in_their_order() {
        assert_eq!(find(&[]), None);
        assert_eq!(find(&[(0, 1), (1, 2), (0, 2)]), None);
        assert_eq!(find(&[(3, 1), (1, 3)]), Some(vec![1, 3, 1]));
        // 0 moves the cycle and is not in it; 1 moves 4, that moves 2, that moves 1.
        let cycle = find(&[(0, 2), (2, 1), (1, 4), (4, 2), (4, 5)]).expect("a cycle");
        assert_eq!(cycle, [1, 4, 2, 1]);
        let names = ["X", "Y", "Z", "A", "B"];
        assert_eq!(message(&cycle, |axis| names[axis]), "Y -> B -> Z -> Y");
    }
}
