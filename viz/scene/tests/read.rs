//! Reader of recordings for the tests, with rerun's decoder.

use std::collections::BTreeSet;
use std::path::Path;

use rerun::external::re_log_encoding::Decoder;
use rerun::external::re_sdk_types::blueprint::archetypes as layout;
use rerun::external::re_sdk_types::blueprint::components::QueryExpression;
use rerun::log::{Chunk, LogMsg};
use rerun::{ComponentDescriptor, components};

use crate::timeline::{LINE, TIME};

/// Contents of a recording.
pub(crate) struct Read {
    pub(crate) chunks: Vec<Chunk>,
    /// The layouts.
    pub(crate) blueprint: Vec<Chunk>,
    pub(crate) activations: usize,
}

impl Read {
    pub(crate) fn new(path: &Path) -> Self {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let (mut chunks, mut blueprint, mut activations) = (Vec::new(), Vec::new(), 0);
        for message in Decoder::<LogMsg>::decode_eager(file).unwrap() {
            match message.unwrap() {
                LogMsg::ArrowMsg(store, message) if store.is_recording() => {
                    chunks.push(Chunk::from_arrow_msg(&message).unwrap());
                }
                LogMsg::ArrowMsg(_, message) => {
                    blueprint.push(Chunk::from_arrow_msg(&message).unwrap());
                }
                LogMsg::BlueprintActivationCommand(_) => activations += 1,
                LogMsg::SetStoreInfo(_) => {}
            }
        }
        Self { chunks, blueprint, activations }
    }

    pub(crate) fn of<'a>(&'a self, entity: &'a str) -> impl Iterator<Item = &'a Chunk> {
        self.chunks
            .iter()
            .filter(move |chunk| *chunk.entity_path() == rerun::EntityPath::from(entity))
    }

    /// Paths of the entities for which `is` holds, each once.
    pub(crate) fn entities(&self, is: impl Fn(&str) -> bool) -> Vec<String> {
        let paths = self.chunks.iter().map(|chunk| chunk.entity_path().to_string());
        paths.filter(|path| is(path)).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// True if a view of the layouts shows this folder.
    pub(crate) fn shows(&self, folder: &str) -> bool {
        let queries = self.of_layout::<QueryExpression>(&layout::ViewContents::descriptor_query());
        queries.iter().any(|query| query.0.as_str() == format!("+ /{folder}/**"))
    }

    /// Positions of an entity, with time (ns) and line.
    pub(crate) fn places(&self, entity: &str) -> Vec<(i64, i64, Vec<components::Translation3D>)> {
        self.rows(entity, &rerun::Transform3D::descriptor_translation())
    }

    /// Rows of a component with their time (ns) and line, in the order of time.
    pub(crate) fn rows<C: rerun::Component>(
        &self,
        entity: &str,
        component: &ComponentDescriptor,
    ) -> Vec<(i64, i64, Vec<C>)> {
        let mut rows = Vec::new();
        for chunk in self.of(entity) {
            let index = |timeline: &'static str| {
                let indices = chunk.iter_component_indices(timeline.into(), component.component);
                indices.map(|(time, _)| time.as_i64())
            };
            let values = chunk.iter_component::<C>(component.component);
            let places = index(TIME).zip(index(LINE)).zip(values);
            rows.extend(
                places.map(|((time, line), values)| (time, line, values.as_slice().to_vec())),
            );
        }
        rows.sort_by_key(|(time, ..)| *time);
        rows
    }

    pub(crate) fn statics<C: rerun::Component>(
        &self,
        entity: &str,
        component: &ComponentDescriptor,
    ) -> Vec<C> {
        values(self.of(entity).filter(|chunk| chunk.is_static()), component)
    }

    /// What `of` takes from each value of a component that has no time.
    pub(crate) fn each<C: rerun::Component, T>(
        &self,
        entity: &str,
        component: &ComponentDescriptor,
        of: impl Fn(C) -> T,
    ) -> Vec<T> {
        self.statics(entity, component).into_iter().map(of).collect()
    }

    /// Names of the lines of a plot.
    pub(crate) fn names(&self, entity: &str) -> Vec<String> {
        let names = rerun::SeriesLines::descriptor_names();
        self.each(entity, &names, |name: components::Name| name.0.as_str().to_owned())
    }

    pub(crate) fn scalars(&self, entity: &str) -> Vec<(i64, i64, f64)> {
        let rows = self.rows::<components::Scalar>(entity, &rerun::Scalars::descriptor_scalars());
        rows.into_iter()
            .flat_map(|(time, line, values)| values.into_iter().map(move |v| (time, line, v.0.0)))
            .collect()
    }

    pub(crate) fn strips(&self, entity: &str) -> Vec<(i64, Vec<[f32; 3]>)> {
        let strips = rerun::LineStrips3D::descriptor_strips();
        let rows = self.rows::<components::LineStrip3D>(entity, &strips).into_iter();
        let strips =
            rows.flat_map(|(time, _, strips)| strips.into_iter().map(move |it| (time, it)));
        strips.map(|(time, strip)| (time, strip.0.iter().map(|point| point.0).collect())).collect()
    }

    /// Values of a component in the layouts.
    pub(crate) fn of_layout<C: rerun::Component>(&self, component: &ComponentDescriptor) -> Vec<C> {
        values(self.blueprint.iter(), component)
    }

    /// Names of the views and containers of the layouts.
    pub(crate) fn names_of_parts(&self) -> Vec<String> {
        let views = layout::ViewBlueprint::descriptor_display_name();
        let containers = layout::ContainerBlueprint::descriptor_display_name();
        let names = [views, containers].map(|name| self.of_layout::<components::Name>(&name));
        names.into_iter().flatten().map(|name| name.0.as_str().to_owned()).collect()
    }
}

fn values<'a, C: rerun::Component>(
    chunks: impl Iterator<Item = &'a Chunk>,
    component: &ComponentDescriptor,
) -> Vec<C> {
    let of = |chunk: &Chunk| {
        let values = chunk.iter_component::<C>(component.component);
        values.into_iter().flat_map(|it| it.as_slice().to_vec()).collect::<Vec<_>>()
    };
    chunks.flat_map(of).collect()
}
