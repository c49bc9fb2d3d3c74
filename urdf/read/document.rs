//! URDF text, checked before it is read: every element has what it needs, in the form that it needs, or the error names
//! the line.

use super::schema::{Form, Rule, SHAPES, rule};
use crate::{Part, UrdfError};
use roxmltree::{Document, Node};

/// URDF has elements within each other six deep; other programs' elements a few more.
const DEEPEST: usize = 64;

/// Something wrong, and in which line.
pub(super) type At<T> = Result<T, (u32, UrdfError)>;

/// A checked text.
pub(super) struct Text<'t> {
    document: Document<'t>,
    /// Where lines begin, but the first.
    starts: Vec<usize>,
}

/// An element of the text.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    starts: &'a [usize],
}

impl<'a> Element<'a> {
    pub(super) fn line(&self) -> u32 {
        let before = self.starts.partition_point(|start| *start <= self.node.range().start);
        u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1)
    }

    /// Its tag.
    pub(super) fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn text(&self, attribute: &str) -> Option<&'a str> {
        self.node.attribute(attribute)
    }

    /// Its attribute `name`.
    pub(super) fn name(&self) -> &'a str {
        self.text("name").unwrap_or_default()
    }

    pub(super) fn numbers<const N: usize>(&self, attribute: &str) -> Option<[f64; N]> {
        let words = self.text(attribute)?.split_whitespace();
        let numbers: Vec<f64> = words.map(str::parse).collect::<Result<_, _>>().ok()?;
        numbers.try_into().ok()
    }

    pub(super) fn number(&self, attribute: &str) -> Option<f64> {
        self.numbers(attribute).map(|[number]| number)
    }

    fn at(&self, node: Node<'a, 'a>) -> Self {
        Self { node, ..*self }
    }

    /// The elements directly within it.
    pub(super) fn all(self) -> impl Iterator<Item = Self> {
        self.node.children().filter(Node::is_element).map(move |node| self.at(node))
    }

    /// The elements with this tag directly within it.
    pub(super) fn children(self, tag: &str) -> impl Iterator<Item = Self> {
        self.all().filter(move |child| child.tag() == tag)
    }

    pub(super) fn child(self, tag: &str) -> Option<Self> {
        self.children(tag).next()
    }

    /// True if its version is 1.`minor` or newer.
    pub(super) fn is_since(&self, minor: u32) -> bool {
        let version = self.text("version").and_then(|text| text.trim().split_once('.'));
        let numbers =
            version.and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
        numbers.is_some_and(|version: (u32, u32)| version >= (1, minor))
    }
}

impl<'t> Text<'t> {
    pub(super) fn new(text: &'t str) -> At<Self> {
        let document = Document::parse(text).map_err(|source| {
            let line = match source {
                // What never ends is missed at the end.
                roxmltree::Error::UnclosedRootNode => {
                    u32::try_from(text.lines().count()).unwrap_or(u32::MAX).max(1)
                }
                _ => source.pos().row,
            };
            match &source {
                roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
                    (line, UrdfError::Xacro)
                }
                _ => (line, UrdfError::Xml(source)),
            }
        })?;
        let starts = text.match_indices('\n').map(|(at, _)| at + 1).collect();
        let text = Self { document, starts };
        let robot = text.robot();
        if robot.tag() != "robot" {
            return Err((robot.line(), UrdfError::Root(robot.tag().to_owned())));
        }
        let mut nodes = robot.node.descendants();
        // Above the robot there is the document.
        if let Some(node) = nodes.find(|node| node.ancestors().nth(DEEPEST + 2).is_some()) {
            let line = robot.at(node.parent().unwrap_or(node)).line();
            return Err((line, UrdfError::Deep(DEEPEST + 1)));
        }
        check_macros(robot)?;
        let versions = Versions { is_1_1: robot.is_since(1), is_1_2: robot.is_since(2) };
        versions.check(robot, None)?;
        Ok(text)
    }

    pub(super) fn robot(&self) -> Element<'_> {
        Element { node: self.document.root_element(), starts: &self.starts }
    }
}

/// That no macros are left.
fn check_macros(robot: Element<'_>) -> At<()> {
    let is_xacro = |node: &Node<'_, '_>| {
        let space = node.tag_name().namespace().unwrap_or_default();
        space.ends_with("wiki/xacro") || space.ends_with("xacro#")
    };
    let is_open = |node: &Node<'_, '_>| {
        let mut values = node.attributes().map(|attribute| attribute.value());
        values.any(|value| value.contains("${") || value.contains("$("))
    };
    let ours = |node: &Node<'_, '_>| rule(node.tag_name().name(), true).is_some();
    let mut elements = robot.node.descendants().filter(Node::is_element);
    match elements.find(|node| is_xacro(node) || ours(node) && is_open(node)) {
        Some(node) => Err((robot.at(node).line(), UrdfError::Xacro)),
        None => Ok(()),
    }
}

/// What the version of the text has.
struct Versions {
    is_1_1: bool,
    is_1_2: bool,
}

impl Versions {
    /// That an element and those in it have what they need, in the form that they need. What URDF does not know is
    /// passed over.
    fn check(&self, element: Element<'_>, part: Option<&Part>) -> At<()> {
        let name = element.tag();
        let Some(rule) = rule(name, self.is_1_2) else { return Ok(()) };
        let named = |part: fn(String) -> Part| Some(part(element.text("name")?.to_owned()));
        let own = match name {
            "link" => named(Part::Link),
            "joint" => named(Part::Joint),
            _ => None,
        };
        let part = own.as_ref().or(part);
        self.attributes(element, &rule, part)?;
        let lacks = |what: &str| {
            let (part, tag) = (part.cloned(), name.to_owned());
            let error = UrdfError::Lacks { part, element: tag, what: what.to_owned() };
            Err((element.line(), error))
        };
        let too_many = |tag: &str, what: String| UrdfError::TooMany {
            part: part.cloned(),
            element: tag.to_owned(),
            what,
        };
        for child in rule.once.iter().chain(rule.at_most_once) {
            let mut found = element.children(child);
            if found.next().is_none() && rule.once.contains(child) {
                return lacks(&format!("<{child}>"));
            }
            if let Some(second) = found.next() {
                let what = format!("<{child}>");
                return Err((second.line(), too_many(name, what)));
            }
        }
        if name == "geometry" {
            let shapes = SHAPES.iter().flat_map(|shape| element.children(shape)).count();
            if shapes == 0 {
                return lacks("shape (box, cylinder, sphere, capsule or mesh)");
            }
            if shapes > 1 {
                return Err((element.line(), too_many(name, "shape".to_owned())));
            }
        }
        for child in rule.once.iter().chain(rule.at_most_once).chain(rule.many) {
            for element in element.children(child) {
                self.check(element, part)?;
            }
        }
        Ok(())
    }

    fn attributes(&self, node: Element<'_>, rule: &Rule, part: Option<&Part>) -> At<()> {
        let element = node.tag().to_owned();
        for (attribute, form) in rule.required.iter().chain(rule.optional) {
            let Some(value) = node.text(attribute) else {
                if rule.required.iter().any(|(required, _)| required == attribute) {
                    let (part, what) = (part.cloned(), (*attribute).to_owned());
                    return Err((node.line(), UrdfError::Lacks { part, element, what }));
                }
                continue;
            };
            if !self.fits(attribute, *form, value) {
                let error = UrdfError::Attribute {
                    part: part.cloned(),
                    element,
                    attribute,
                    value: value.to_owned(),
                    expected: form.expected(),
                };
                return Err((node.line(), error));
            }
        }
        if self.is_1_1 && node.text("rpy").and(node.text("quat_xyzw")).is_some() {
            let what = "of rpy and quat_xyzw: they say the same".to_owned();
            let error = UrdfError::TooMany { part: part.cloned(), element, what };
            return Err((node.line(), error));
        }
        Ok(())
    }

    fn fits(&self, attribute: &str, form: Form, value: &str) -> bool {
        // Before URDF 1.1 it meant nothing.
        attribute == "quat_xyzw" && !self.is_1_1 || form.fits(value)
    }
}
