//! Pairs of parts that may touch each other.

use twin_urdf::Model;

use crate::surroundings::{Part, Surroundings};

/// The numbered parts of a machine and its surroundings, and the pairs of them that may touch.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    /// With the link whose frame each is in; 0 is the machine frame.
    parts: Vec<(Part, usize)>,
    /// One per pair, rows of `parts`.
    may_touch: Vec<bool>,
}

impl Pairs {
    /// Everything solid of `model` and `surroundings`.
    pub(super) fn new(model: &Model, surroundings: &Surroundings, has_tool: bool) -> Self {
        let links = model.links.iter().enumerate();
        let mut parts: Vec<_> = links.map(|(link, _)| (Part::Link(link), link)).collect();
        if has_tool {
            parts.push((Part::Tool, model.tip.link));
        }
        parts.extend((0..surroundings.obstacles.len()).map(|index| (Part::Obstacle(index), 0)));
        parts.extend((0..surroundings.bodies.len()).map(|index| (Part::Body(index), 0)));
        let groups = Groups::of(model);
        let among =
            |one: usize, other: usize| surroundings.among_links && !groups.are_joined(one, other);
        let may_touch = parts.iter().flat_map(|one| parts.iter().map(move |other| [one, other]));
        let may_touch = may_touch.map(|[(one, link), (other, other_link)]| {
            let obstacles = [one, other].map(|part| matches!(part, Part::Obstacle(_)));
            // Distances of loose bodies are found by rapier alone.
            if [one, other].iter().any(|part| matches!(part, Part::Body(_))) {
                return false;
            }
            let moves = |link: usize| groups.moves(link);
            let possible = match obstacles {
                [true, true] => false,
                [false, true] => moves(*link),
                [true, false] => moves(*other_link),
                [false, false] => among(*link, *other_link),
            };
            possible && !surroundings.leaves_out([*one, *other])
        });
        let may_touch = may_touch.collect();
        Self { parts, may_touch }
    }

    /// The parts by number, each with the link in whose frame it is.
    pub(super) fn parts(&self) -> &[(Part, usize)] {
        &self.parts
    }

    pub(super) fn part(&self, number: usize) -> Option<Part> {
        self.parts.get(number).map(|(part, _)| *part)
    }

    fn place(&self, one: usize, other: usize) -> Option<usize> {
        (other < self.parts.len()).then(|| one * self.parts.len() + other)
    }

    /// True if two parts of these numbers may touch.
    pub(super) fn may_touch(&self, one: usize, other: usize) -> bool {
        let place = self.place(one, other);
        place.and_then(|place| self.may_touch.get(place)).copied().unwrap_or_default()
    }
}

/// Links that move together, and which of these groups joints join.
struct Groups {
    /// The group of each link.
    group: Vec<usize>,
    joined: Vec<[usize; 2]>,
}

impl Groups {
    /// Links on fixed joints are one with their parents. Links without solids that move, as the crosses of universal joints, are passed
    /// over: what they join is joined.
    fn of(model: &Model) -> Self {
        let mut group: Vec<usize> = (0..model.links.len()).collect();
        let find = |group: &[usize], link: usize| group.get(link).copied().unwrap_or(link);
        let unite = |group: &mut [usize], one: usize, other: usize| {
            let [one, other] = [one, other].map(|link| find(group, link));
            for slot in group.iter_mut().filter(|slot| **slot == other) {
                *slot = one;
            }
        };
        let mut joined = Vec::new();
        for joint in &model.joints {
            if joint.kind == twin_urdf::JointKind::Fixed {
                unite(&mut group, joint.parent, joint.child);
            } else {
                joined.push([joint.parent, joint.child]);
            }
        }
        joined.extend(model.loops.iter().map(|one| one.links));
        let mut joined: Vec<_> = joined
            .into_iter()
            .map(|pair: [usize; 2]| pair.map(|link| find(&group, link)))
            .collect();
        let is_bare = |one: usize| {
            let mut links = model.links.iter().zip(&group).filter(|(_, group)| **group == one);
            one != find(&group, 0) && links.all(|(link, _)| link.collision_solids().is_empty())
        };
        // Around groups without solids, until nothing is new.
        let mut known = 0;
        while known < joined.len() {
            known = joined.len();
            let both = |[a, b]: [usize; 2]| [[a, b], [b, a]];
            let ways: Vec<_> = joined.iter().copied().flat_map(both).collect();
            for [one, through] in ways.iter().filter(|[_, through]| is_bare(*through)) {
                let others = ways.iter().filter(|[by, other]| by == through && other != one);
                for [_, other] in others {
                    if !joined.contains(&[*one, *other]) && !joined.contains(&[*other, *one]) {
                        joined.push([*one, *other]);
                    }
                }
            }
        }
        Self { group, joined }
    }

    fn of_link(&self, link: usize) -> usize {
        self.group.get(link).copied().unwrap_or(link)
    }

    /// True if the link is not fixed to the machine frame.
    fn moves(&self, link: usize) -> bool {
        self.of_link(link) != self.of_link(0)
    }

    /// True if they move together or are the two sides of a joint.
    fn are_joined(&self, one: usize, other: usize) -> bool {
        let pair = [one, other].map(|link| self.of_link(link));
        let [one, other] = pair;
        one == other || self.joined.contains(&pair) || self.joined.contains(&[other, one])
    }
}
