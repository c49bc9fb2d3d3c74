//! Backlog: parts of the path that are known and not planned, or taken back for replanning.

use super::{After, Leg, LimitError, Planned, Planner};
use crate::blended_path::BlendedElement;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::cell::Cell;
use crate::time_optimal::sample::SAME_PLACE;
use crate::time_optimal::smooth::Beginning;
use std::collections::VecDeque;
use std::sync::Arc;
use twin_path::prepare::CheckedElement;

/// The root of what is left of u̇² by rounding where the path rests, m/s.
const AT_REST: f64 = 1e-7;

/// A part of an element, m.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) element: Arc<BlendedElement>,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Part {
    /// All of an element.
    pub(super) fn whole(element: Arc<BlendedElement>) -> Self {
        Self { from: 0.0, to: element.length(), element }
    }

    fn of(leg: &Leg) -> Self {
        let element = Arc::clone(&leg.element);
        Self { element, from: leg.from, to: leg.from + leg.stretch.length() }
    }

    /// True if it goes to the end of its element.
    pub(super) fn ends(&self) -> bool {
        let length = self.element.length();
        self.to >= length - SAME_PLACE * length
    }

    /// True if `next` follows on the same element.
    fn leads_to(&self, next: &Self) -> bool {
        let apart = SAME_PLACE * self.element.length();
        Arc::ptr_eq(&self.element, &next.element) && (next.from - self.to).abs() <= apart
    }
}

/// Item of the backlog, before the rest of the course.
#[derive(Debug)]
pub(super) enum Backlog<E> {
    Part(Part),
    Pause(Arc<BlendedElement>),
    Error(LimitError<E>),
    /// Here the path is to rest.
    Hold,
}

/// The parts of elements that `cells` are.
pub(super) fn parts(cells: &[Cell]) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    for cell in cells {
        match parts.last_mut() {
            Some(last) if Arc::ptr_eq(&last.element, &cell.element) => last.to = cell.to,
            _ => parts.push(Part {
                element: Arc::clone(&cell.element),
                from: cell.from,
                to: cell.to,
            }),
        }
    }
    parts
}

/// True if the path rests with this u̇².
pub(super) fn rests(b: f64) -> bool {
    b <= AT_REST * AT_REST
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Takes back what was handed out last and will not be executed: `planned`, in its order and without gaps, up to the newest
    /// item. It comes again, planned anew from where its first item begins. Nothing of the path is lost or repeated, pauses and
    /// errors come again in their places.
    pub fn take_back(&mut self, planned: impl IntoIterator<Item = Result<Planned, LimitError<E>>>) {
        let mut items: VecDeque<_> = planned.into_iter().collect();
        items.extend(self.ready.drain(..));
        items.retain(|item| !matches!(item, Ok(Planned::Hold { .. })));
        self.unplan();
        self.held = false;
        self.changed = true;
        let Some(first) = items.front() else { return };
        self.over = false;
        self.beginning = match first {
            Ok(Planned::Leg(leg)) => match leg.stretch.at_position(0.0) {
                (b, _) if rests(b) => Beginning::Rest,
                (b, a) => Beginning::Moving { b, a },
            },
            _ => Beginning::Rest,
        };
        let first = items.iter().find_map(|item| match item {
            Ok(Planned::Leg(leg)) => Some(leg.start),
            _ => None,
        });
        self.near = first.unwrap_or(self.near);
        self.set_old(&items);
        for item in items.into_iter().rev() {
            match item {
                Ok(Planned::Leg(leg)) => self.return_part(Part::of(&leg)),
                Ok(Planned::Pause(element)) => self.returned.push_front(Backlog::Pause(element)),
                Ok(Planned::Hold { .. }) => {}
                Err(error) => self.returned.push_front(Backlog::Error(error)),
            }
        }
    }

    /// Takes the next item along the path.
    pub(super) fn take_next(&mut self) -> Option<Backlog<E>> {
        self.returned.pop_front().or_else(|| {
            Some(match self.course.next()? {
                Ok(element) if element.length() <= 0.0 => Backlog::Pause(Arc::new(element)),
                Ok(element) => Backlog::Part(Part::whole(Arc::new(element))),
                Err(error) => Backlog::Error(LimitError::Upstream(error)),
            })
        })
    }

    /// Hold item while the path is held: the place where it would go on.
    pub(super) fn hold(&mut self) -> Option<Result<Planned, LimitError<E>>> {
        loop {
            let (next, element, at) = match self.take_next() {
                Some(Backlog::Part(part)) => {
                    let (element, at) = (Arc::clone(&part.element), part.from);
                    (Backlog::Part(part), element, at)
                }
                Some(Backlog::Pause(element)) => {
                    (Backlog::Pause(Arc::clone(&element)), element, 0.0)
                }
                Some(Backlog::Error(error)) => return Some(Err(error)),
                Some(Backlog::Hold) => continue,
                None => {
                    self.over = true;
                    return None;
                }
            };
            self.returned.push_front(next);
            return Some(Ok(Planned::Hold { element, at }));
        }
    }

    /// The plan so far from the first of `items` to where the path next rests.
    fn set_old(&mut self, items: &VecDeque<Result<Planned, LimitError<E>>>) {
        let mut old: Vec<Leg> = Vec::new();
        let mut on = true;
        for item in items {
            let Ok(Planned::Leg(leg)) = item else {
                on = false;
                break;
            };
            old.push(leg.clone());
            if rests(leg.stretch.at_position(leg.stretch.length()).0) {
                on = false;
                break;
            }
        }
        if on {
            old.append(&mut self.tail);
        }
        self.tail = old;
    }

    /// Puts a part before what is to be planned.
    fn return_part(&mut self, part: Part) {
        match self.returned.front_mut() {
            Some(Backlog::Part(next)) if part.leads_to(next) => next.from = part.from,
            _ => self.returned.push_front(Backlog::Part(part)),
        }
    }

    /// Forgets the cells: what they are of is to be planned. Where the path was to be held it is not any more.
    pub(super) fn unplan(&mut self) {
        match self.after.take() {
            Some(After::Pause(element)) => self.returned.push_front(Backlog::Pause(element)),
            Some(After::Error(error)) => self.returned.push_front(Backlog::Error(error)),
            Some(After::Path | After::Hold | After::End) | None => {}
        }
        if let Some(first) = self.cells.first() {
            self.near = first.start.position;
        }
        let cells = std::mem::take(&mut self.cells);
        self.return_cells(&cells);
        self.kept.clear();
        self.returned.retain(|returned| !matches!(returned, Backlog::Hold));
    }

    fn return_cells(&mut self, cells: &[Cell]) {
        for part in parts(cells).into_iter().rev() {
            self.return_part(part);
        }
    }

    /// Gives back `cells`, which are behind the window, and what follows them.
    pub(super) fn return_beyond(&mut self, cells: &[Cell]) {
        match self.after.take() {
            Some(After::Pause(element)) => self.returned.push_front(Backlog::Pause(element)),
            Some(After::Error(error)) => self.returned.push_front(Backlog::Error(error)),
            Some(After::Hold) => self.returned.push_front(Backlog::Hold),
            Some(After::Path | After::End) | None => {}
        }
        self.return_cells(cells);
        if let Some(last) = self.cells.last() {
            self.near = last.end.position;
        }
    }

    /// Drops what is to be planned up to `s` of `element`.
    pub(super) fn skip_to(&mut self, element: &Arc<BlendedElement>, s: f64) {
        while let Some(Backlog::Part(part)) = self.returned.front_mut() {
            let own = Arc::ptr_eq(&part.element, element);
            let near = SAME_PLACE * element.length();
            if own && part.to > s + near {
                part.from = s;
                return;
            }
            // An element may be in several parts.
            let reached = own && part.to >= s - near;
            self.returned.pop_front();
            if reached {
                return;
            }
        }
    }

    /// Drops a pause or an error that is next.
    pub(super) fn skip_pause(&mut self) {
        if let Some(Backlog::Pause(_) | Backlog::Error(_)) = self.returned.front() {
            self.returned.pop_front();
        }
    }

    /// The path is to rest at `s` of `element`, which is to be planned.
    pub(super) fn hold_at(&mut self, element: &Arc<BlendedElement>, s: f64) {
        if let Some(behind) = self.split_at(element, s) {
            self.returned.insert(behind, Backlog::Hold);
        }
    }

    /// Parts what is to be planned at `s` of `element`, which it is a part of; what is behind.
    pub(super) fn split_at(&mut self, element: &Arc<BlendedElement>, s: f64) -> Option<usize> {
        let near = SAME_PLACE * element.length();
        let place = self.returned.iter().position(|returned| {
            matches!(returned, Backlog::Part(part)
                if Arc::ptr_eq(&part.element, element) && part.to >= s - near)
        });
        let index = place?;
        if let Some(Backlog::Part(part)) = self.returned.get_mut(index)
            && part.to > s + near
        {
            if part.from >= s - near {
                // What is left of it in front would be rounding.
                return Some(index);
            }
            let behind = Part { from: s, ..part.clone() };
            part.to = s;
            self.returned.insert(index + 1, Backlog::Part(behind));
        }
        Some(index + 1)
    }
}
