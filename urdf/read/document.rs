//! Survey of URDF text before urdf-rs reads it. urdf-rs does not report lines, so this pass finds every error that
//! urdf-rs would find, with its line. It also notes the line of each link and joint for later errors.

use super::schema::{Form, Rule, SHAPES, rule};
use crate::{Part, QUATERNION, UrdfError};
use quick_xml::Reader;
use quick_xml::events::Event;
use roxmltree::{Document, Node};

/// URDF has elements within each other six deep; other programs' elements a few more.
const DEEPEST: usize = 64;
/// Most attributes of an element, of which URDF has ten, and most namespaces of a file, of which it has none. Reading takes
/// a time that grows with their square.
const MOST_ATTRIBUTES: usize = 100;
const MOST_NAMESPACES: usize = 100;

/// Something wrong, and in which line.
pub(super) type At<T> = Result<T, (u32, UrdfError)>;

/// Lines of the links, joints and extensions in the text.
#[derive(Debug, Default)]
pub(super) struct Places {
    pub(super) robot: u32,
    pub(super) links: Vec<LinkPlaces>,
    pub(super) joints: Vec<JointPlaces>,
    /// Extensions in `<twin>`, each with its line.
    pub(super) beyond: Vec<(u32, Beyond)>,
}

/// Extension of `<twin>` that URDF itself cannot express.
#[derive(Clone, Debug)]
pub(super) enum Beyond {
    /// A joint that one axis moves.
    Axis { joint: String, axis: usize },
    /// A joint that several axes move.
    Combination { joint: String, parts: Vec<(usize, f64)> },
    /// A joint that no axis moves.
    Passive { joint: String, rest: f64 },
    /// Links that hold each other.
    Loop { links: [String; 2], points: Vec<[f64; 3]> },
}

/// A link in the text.
#[derive(Debug, Default)]
pub(super) struct LinkPlaces {
    pub(super) line: u32,
    pub(super) inertial: OriginPlace,
    pub(super) visuals: Vec<OriginPlace>,
    pub(super) collisions: Vec<OriginPlace>,
}

/// A joint in the text.
#[derive(Debug, Default)]
pub(super) struct JointPlaces {
    pub(super) line: u32,
    pub(super) origin: OriginPlace,
    elements: Vec<(String, u32)>,
}

/// An element with an `<origin>`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OriginPlace {
    /// Of the element.
    pub(super) line: u32,
    /// Quaternion of the origin, w x y z, to the last digit.
    pub(super) exact: Option<[f64; 4]>,
    /// Quaternion in place of roll, pitch and yaw (URDF 1.1), w x y z.
    pub(super) given: Option<[f64; 4]>,
}

impl JointPlaces {
    /// The line of an element of the joint; of the joint, if it has none.
    pub(super) fn of(&self, element: &str) -> u32 {
        let found = self.elements.iter().find(|(name, _)| name == element);
        found.map_or(self.line, |(_, line)| *line)
    }
}

impl Places {
    pub(super) fn link(&self, index: usize) -> u32 {
        self.links.get(index).map_or(self.robot, |link| link.line)
    }

    pub(super) fn joint(&self, index: usize) -> u32 {
        self.joints.get(index).map_or(self.robot, |joint| joint.line)
    }
}

/// Looks through `text`.
pub(super) fn survey(text: &str) -> At<Places> {
    bound(text)?;
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
    let starts: Vec<_> = text.match_indices('\n').map(|(at, _)| at + 1).collect();
    let root = document.root_element();
    let survey = Survey { starts, is_1_1: is_since(&root, 1), is_1_2: is_since(&root, 2) };
    if root.tag_name().name() != "robot" {
        let found = root.tag_name().name().to_owned();
        return Err((survey.line(&root), UrdfError::Root(found)));
    }
    survey.macros(&root)?;
    survey.element(&root, None)?;
    Ok(survey.places(&root))
}

/// Refuses text that would take long to read. Where it is not XML, the pass that follows says why.
fn bound(text: &str) -> At<()> {
    let mut reader = Reader::from_str(text);
    let (mut depth, mut namespaces) = (0_usize, 0);
    loop {
        let from = usize::try_from(reader.buffer_position()).unwrap_or(usize::MAX);
        let (tag, inner) = match reader.read_event() {
            Ok(Event::Start(tag)) => (tag, 1),
            Ok(Event::Empty(tag)) => (tag, 0),
            Ok(Event::End(_)) => {
                depth = depth.saturating_sub(1);
                continue;
            }
            Ok(Event::Eof) | Err(_) => return Ok(()),
            Ok(_) => continue,
        };
        let mut attributes = 0;
        for attribute in tag.attributes().with_checks(false) {
            attributes += 1;
            let is_namespace = |name: &[u8]| name.starts_with(b"xmlns");
            namespaces += usize::from(attribute.is_ok_and(|it| is_namespace(it.key.as_ref())));
        }
        let error = if depth > DEEPEST {
            UrdfError::Deep(depth)
        } else if attributes > MOST_ATTRIBUTES {
            UrdfError::Attributes { count: attributes, most: MOST_ATTRIBUTES }
        } else if namespaces > MOST_NAMESPACES {
            UrdfError::Namespaces { most: MOST_NAMESPACES }
        } else {
            depth += inner;
            continue;
        };
        let lines = text.get(..from).unwrap_or_default().matches('\n').count();
        return Err((u32::try_from(lines).unwrap_or(u32::MAX).saturating_add(1), error));
    }
}

/// True if the text is of version 1.`minor` or newer.
fn is_since(root: &Node<'_, '_>, minor: u32) -> bool {
    super::version(root.attribute("version")).is_some_and(|version| version >= (1, minor))
}

struct Survey {
    /// Where lines begin, but the first.
    starts: Vec<usize>,
    is_1_1: bool,
    is_1_2: bool,
}

impl Survey {
    fn line(&self, node: &Node<'_, '_>) -> u32 {
        let before = self.starts.partition_point(|start| *start <= node.range().start);
        u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1)
    }

    /// That no macros are left.
    fn macros(&self, root: &Node<'_, '_>) -> At<()> {
        let is_xacro = |node: &Node<'_, '_>| {
            let space = node.tag_name().namespace().unwrap_or_default();
            space.ends_with("wiki/xacro") || space.ends_with("xacro#")
        };
        let is_open = |node: &Node<'_, '_>| {
            let values = node.attributes().map(|attribute| attribute.value());
            values.into_iter().any(|value| value.contains("${") || value.contains("$("))
        };
        let ours = |node: &Node<'_, '_>| rule(node.tag_name().name(), true).is_some();
        let mut elements = root.descendants().filter(Node::is_element);
        match elements.find(|node| is_xacro(node) || ours(node) && is_open(node)) {
            Some(node) => Err((self.line(&node), UrdfError::Xacro)),
            None => Ok(()),
        }
    }

    /// That an element and those in it have what they need, in the form that they need. What URDF does not know is
    /// passed over.
    fn element(&self, node: &Node<'_, '_>, part: Option<&Part>) -> At<()> {
        let name = node.tag_name().name();
        let Some(rule) = rule(name, self.is_1_2) else { return Ok(()) };
        let named = |part: fn(String) -> Part| Some(part(node.attribute("name")?.to_owned()));
        let own = match name {
            "link" => named(Part::Link),
            "joint" => named(Part::Joint),
            _ => None,
        };
        let part = own.as_ref().or(part);
        self.attributes(node, &rule, part)?;
        let lacks = |what: &str| {
            let (part, element) = (part.cloned(), name.to_owned());
            Err((self.line(node), UrdfError::Lacks { part, element, what: what.to_owned() }))
        };
        for child in rule.once.iter().chain(rule.at_most_once) {
            let mut found = elements(node, child);
            if found.next().is_none() && rule.once.contains(child) {
                return lacks(&format!("<{child}>"));
            }
            if let Some(second) = found.next() {
                let (part, element) = (part.cloned(), name.to_owned());
                let error = UrdfError::TooMany { part, element, what: format!("<{child}>") };
                return Err((self.line(&second), error));
            }
        }
        if name == "geometry" {
            let shapes = SHAPES.iter().flat_map(|shape| elements(node, shape)).count();
            if shapes == 0 {
                return lacks("shape (box, cylinder, sphere, capsule or mesh)");
            }
            if shapes > 1 {
                let (part, element) = (part.cloned(), name.to_owned());
                let error = UrdfError::TooMany { part, element, what: "shape".to_owned() };
                return Err((self.line(node), error));
            }
        }
        for child in rule.once.iter().chain(rule.at_most_once).chain(rule.many) {
            for element in elements(node, child) {
                self.element(&element, part)?;
            }
        }
        Ok(())
    }

    fn attributes(&self, node: &Node<'_, '_>, rule: &Rule, part: Option<&Part>) -> At<()> {
        let element = node.tag_name().name().to_owned();
        for (attribute, form) in rule.required.iter().chain(rule.optional) {
            let Some(value) = node.attribute(*attribute) else {
                if rule.required.iter().any(|(required, _)| required == attribute) {
                    let (part, what) = (part.cloned(), (*attribute).to_owned());
                    return Err((self.line(node), UrdfError::Lacks { part, element, what }));
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
                return Err((self.line(node), error));
            }
        }
        if self.is_1_1 && node.has_attribute("rpy") && node.has_attribute("quat_xyzw") {
            let what = "of rpy and quat_xyzw: they say the same".to_owned();
            let error = UrdfError::TooMany { part: part.cloned(), element, what };
            return Err((self.line(node), error));
        }
        Ok(())
    }

    fn fits(&self, attribute: &str, form: Form, value: &str) -> bool {
        // Before URDF 1.1 it meant nothing.
        attribute == "quat_xyzw" && !self.is_1_1 || form.fits(value)
    }

    fn places(&self, root: &Node<'_, '_>) -> Places {
        let origins = |node: &Node<'_, '_>, name: &str| {
            elements(node, name).map(|element| self.origin(&element)).collect::<Vec<_>>()
        };
        let link = |node: Node<'_, '_>| LinkPlaces {
            line: self.line(&node),
            inertial: origins(&node, "inertial").first().copied().unwrap_or_default(),
            visuals: origins(&node, "visual"),
            collisions: origins(&node, "collision"),
        };
        let joint = |node: Node<'_, '_>| JointPlaces {
            line: self.line(&node),
            origin: self.origin(&node),
            elements: node
                .children()
                .filter(Node::is_element)
                .map(|element| (element.tag_name().name().to_owned(), self.line(&element)))
                .collect(),
        };
        Places {
            robot: self.line(root),
            links: elements(root, "link").map(link).collect(),
            joints: elements(root, "joint").map(joint).collect(),
            beyond: elements(root, "twin")
                .flat_map(|twin| twin.children().filter(Node::is_element))
                .filter_map(|element| Some((self.line(&element), beyond(&element)?)))
                .collect(),
        }
    }

    fn origin(&self, node: &Node<'_, '_>) -> OriginPlace {
        let origin = elements(node, "origin").next();
        let numbers = |attribute: &str| numbers(&origin?, attribute);
        let given = numbers("quat_xyzw").filter(|_| self.is_1_1);
        let line = self.line(node);
        OriginPlace {
            line,
            exact: numbers(QUATERNION),
            given: given.map(|[x, y, z, w]| [w, x, y, z]),
        }
    }
}

fn numbers<const N: usize>(node: &Node<'_, '_>, attribute: &str) -> Option<[f64; N]> {
    let words = node.attribute(attribute)?.split_whitespace();
    let numbers: Vec<f64> = words.map(str::parse).collect::<Result<_, _>>().ok()?;
    numbers.try_into().ok()
}

fn beyond(node: &Node<'_, '_>) -> Option<Beyond> {
    let text = |name: &str| node.attribute(name).map(str::to_owned);
    let index = |node: &Node<'_, '_>| node.attribute("axis")?.parse().ok();
    let part = |part: Node<'_, '_>| Some((index(&part)?, numbers::<1>(&part, "factor")?[0]));
    Some(match node.tag_name().name() {
        "drive" => match index(node) {
            Some(axis) => Beyond::Axis { joint: text("joint")?, axis },
            None => Beyond::Combination {
                joint: text("joint")?,
                parts: elements(node, "part").filter_map(part).collect(),
            },
        },
        "passive" => {
            let [rest] = numbers(node, "rest")?;
            Beyond::Passive { joint: text("joint")?, rest }
        }
        "loop" => Beyond::Loop {
            links: [text("from")?, text("to")?],
            points: elements(node, "point").filter_map(|point| numbers(&point, "xyz")).collect(),
        },
        _ => return None,
    })
}

/// The elements of this name directly within `node`.
fn elements<'a, 'input: 'a>(
    node: &Node<'a, 'input>,
    name: &str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    let name = name.to_owned();
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}
