//! Reader of recordings that the binary has written.

use crate::desk::Desk;
use rerun::ComponentDescriptor;
use rerun::external::re_log_encoding::Decoder;
use rerun::log::{Chunk, LogMsg};
use std::collections::BTreeSet;

/// The file that is read.
pub(crate) const RECORDING: &str = "r.rrd";

/// All of it but the layouts.
pub(crate) fn chunks(desk: &Desk) -> Vec<Chunk> {
    let file = std::fs::File::open(desk.path(RECORDING)).expect("a recording");
    let messages = Decoder::<LogMsg>::decode_eager(std::io::BufReader::new(file)).expect("one");
    let messages = messages.map(|message| message.expect("a message"));
    let chunks = messages.filter_map(|message| match message {
        LogMsg::ArrowMsg(store, message) if store.is_recording() => {
            Some(Chunk::from_arrow_msg(&message).expect("a chunk"))
        }
        _ => None,
    });
    chunks.collect()
}

/// Entities of the recording.
pub(crate) fn entities(chunks: &[Chunk]) -> BTreeSet<String> {
    chunks.iter().map(|chunk| chunk.entity_path().to_string()).collect()
}

/// Rows of a component of an entity with their times, ns; those of what is there for good have the time 0.
pub(crate) fn rows<C: rerun::Component>(
    chunks: &[Chunk],
    entity: &str,
    component: &ComponentDescriptor,
) -> Vec<(i64, Vec<C>)> {
    let mut rows = Vec::new();
    for chunk in chunks.iter().filter(|it| *it.entity_path() == rerun::EntityPath::from(entity)) {
        let times = chunk.iter_component_indices("time".into(), component.component);
        let times: Vec<_> = times.map(|(time, _)| time.as_i64()).collect();
        let times = times.into_iter().chain(std::iter::repeat(0));
        let values = chunk.iter_component::<C>(component.component);
        rows.extend(times.zip(values.into_iter().map(|value| value.as_slice().to_vec())));
    }
    rows.sort_by_key(|(time, _)| *time);
    rows
}

/// Values of a series in the recording on `desk`, in the order of time.
pub(crate) fn recorded(desk: &Desk, entity: &str) -> Vec<f64> {
    series(&chunks(desk), entity).into_iter().map(|(_, value)| value).collect()
}

/// Values of a series with their times, ns.
pub(crate) fn series(chunks: &[Chunk], entity: &str) -> Vec<(i64, f64)> {
    let scalars = rerun::Scalars::descriptor_scalars();
    let rows = rows::<rerun::components::Scalar>(chunks, entity, &scalars);
    rows.into_iter().map(|(time, value)| (time, value[0].0.0)).collect()
}
