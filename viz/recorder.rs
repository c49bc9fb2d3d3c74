//! Recorder: turns what is logged into chunks of a rerun recording, and passes them to a file in the background.
//!
//! rerun's own stream batches by the wall clock and numbers rows by it. Here the program's time alone decides, and rows
//! count up: equal runs make equal recordings.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::{EncodeError, Encoder, EncodingOptions, MessageHeader};
use rerun::external::re_log_types::{
    BlueprintActivationCommand, SetStoreInfo, StoreInfo, StoreSource,
};
use rerun::log::{Chunk, ChunkId, LogMsg, RowId};
use rerun::{
    AsComponents, EntityPath, RecordingInfo, SerializedComponentBatch, SerializedComponentColumn,
    SizeBytes, StoreId, StoreKind, TimeCell, TimeColumn, TimePoint,
};

use crate::background::{Background, Item, Sink};
use crate::error::{Result, VizError};
use crate::timeline::{LINE, TIME};

/// Name under which the viewer groups our recordings.
const APPLICATION: &str = "twin";
/// How long a file may hold up a recording that nothing waits for.
const PATIENCE: Duration = Duration::from_secs(1);
/// More rows than this are not held back.
const MOST_ROWS: u64 = 4096;

/// Rows of a recording, and where they go.
pub(crate) struct Recorder {
    store: StoreId,
    /// First half of the number of every row and chunk.
    stem: u64,
    /// Second half of the next one.
    next: u64,
    time: TimePoint,
    /// Rows that are held back.
    rows: BTreeMap<EntityPath, (ChunkId, Vec<Row>)>,
    held_back: u64,
    layouts: u32,
    output: Output,
}

/// Values of an entity at a time.
type Row = (RowId, TimePoint, Vec<SerializedComponentBatch>);

enum Output {
    Memory(Vec<LogMsg>),
    File { path: PathBuf, file: Background<LogMsg>, patience: Duration },
}

impl fmt::Debug for Recorder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recorder").field("store", &self.store).finish_non_exhaustive()
    }
}

impl Recorder {
    /// Begins the recording `number`, a random one if there is none, called `title`, in a file.
    ///
    /// Errors: [`VizError::Create`] if the file cannot be created.
    pub(crate) fn create(path: &Path, title: &str, number: Option<u64>) -> Result<Self> {
        let name = path.to_owned();
        let file = Background::open("recording", move || RecordingFile::create(name));
        let file = file.map_err(|source| VizError::Create { path: path.to_owned(), source })?;
        let stem = number.unwrap_or_else(|| RandomState::new().hash_one(0));
        let output = Output::File { path: path.to_owned(), file, patience: PATIENCE };
        let mut recorder = Self::begin(StoreKind::Recording, format!("{stem:016x}"), stem, output);
        recorder.log_static(EntityPath::properties(), &RecordingInfo::new().with_name(title))?;
        Ok(recorder)
    }

    /// A layout for this recording, to be sent with [`Self::send_layout`].
    pub(crate) fn layout(&mut self) -> Self {
        self.layouts += 1;
        let id = format!("{}-layout-{}", self.store.recording_id().as_str(), self.layouts);
        let output = Output::Memory(Vec::new());
        let mut layout = Self::begin(StoreKind::Blueprint, id, self.stem, output);
        layout.time = TimePoint::from([("blueprint", TimeCell::from_sequence(0))]);
        layout
    }

    fn begin(kind: StoreKind, id: String, stem: u64, output: Output) -> Self {
        let mut recorder = Self {
            store: StoreId::new(kind, APPLICATION, id),
            // Numbers of rerun begin with a time in ns, in which this bit is not set.
            stem: stem >> 1,
            next: 1,
            time: TimePoint::default(),
            rows: BTreeMap::new(),
            held_back: 0,
            layouts: 0,
            output,
        };
        let source = StoreSource::Other(APPLICATION.to_owned());
        let info = StoreInfo::new(recorder.store.clone(), source);
        let row_id = *RowId::from_u128(recorder.number());
        recorder.pass_on((0, 0), [0, 1], LogMsg::SetStoreInfo(SetStoreInfo { row_id, info }));
        recorder
    }

    fn number(&mut self) -> u128 {
        self.next += 1;
        (u128::from(self.stem) << 64) | u128::from(self.next)
    }

    /// From here on a file that is full or slow costs data instead of time.
    pub(crate) fn hurry(&mut self) {
        if let Output::File { patience, .. } = &mut self.output {
            *patience = Duration::ZERO;
        }
    }

    /// Everything logged from here on is at this time, ns, and line.
    pub(crate) fn set_time(&mut self, time_ns: i64, line: u32) {
        let time = TimeCell::from_duration_nanos(time_ns);
        let line = TimeCell::from_sequence(i64::from(line));
        self.time = TimePoint::from([(TIME, time), (LINE, line)]);
    }

    /// Logs values of an entity at the time set.
    pub(crate) fn log(
        &mut self,
        entity: impl Into<EntityPath>,
        values: &impl AsComponents,
    ) -> Result<()> {
        let batches = values.as_serialized_batches();
        if batches.is_empty() {
            return Ok(());
        }
        let (chunk, row) = (self.number(), RowId::from_u128(self.number()));
        let rows = self.rows.entry(entity.into());
        let (_, rows) = rows.or_insert_with(|| (ChunkId::from_u128(chunk), Vec::new()));
        rows.push((row, self.time.clone(), batches));
        self.held_back += 1;
        if self.held_back >= MOST_ROWS { self.flush() } else { Ok(()) }
    }

    /// Logs values of an entity that are there at all times.
    pub(crate) fn log_static(
        &mut self,
        entity: impl Into<EntityPath>,
        values: &impl AsComponents,
    ) -> Result<()> {
        let chunk = ChunkId::from_u128(self.number());
        let row = RowId::from_u128(self.number());
        let chunk = Chunk::builder_with_id(chunk, entity);
        let chunk = chunk.with_archetype(row, TimePoint::default(), values).build()?;
        self.send_chunk(&chunk)
    }

    /// Logs many values of an entity with their times.
    pub(crate) fn send_columns(
        &mut self,
        entity: &str,
        times: impl IntoIterator<Item = TimeColumn>,
        values: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<()> {
        let times = times.into_iter().map(|times| (*times.timeline().name(), times)).collect();
        let values = values.into_iter().map(|values| (values.descriptor, values.list_array));
        let id = ChunkId::from_u128(self.number());
        let chunk = Chunk::from_auto_row_ids(id, entity.into(), times, values.collect())?;
        // The rows have the numbers that follow.
        self.next += u64::try_from(chunk.num_rows()).unwrap_or(0);
        self.send_chunk(&chunk)
    }

    /// Sends what is held back.
    pub(crate) fn flush(&mut self) -> Result<()> {
        self.held_back = 0;
        for (entity, (id, rows)) in std::mem::take(&mut self.rows) {
            let mut chunk = Chunk::builder_with_id(id, entity);
            for (row, time, batches) in rows {
                chunk = chunk.with_serialized_batches(row, time, batches);
            }
            self.send_chunk(&chunk.build()?)?;
        }
        Ok(())
    }

    /// Sends a layout, which becomes that of the page.
    pub(crate) fn send_layout(&mut self, mut layout: Self) -> Result<()> {
        layout.flush()?;
        if let Output::Memory(messages) = layout.output {
            let blueprint_id = layout.store;
            let activation =
                BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true };
            let activation = LogMsg::BlueprintActivationCommand(activation);
            for message in messages.into_iter().chain([activation]) {
                self.pass_on((0, 0), [0, 1], message);
            }
        }
        Ok(())
    }

    /// Completes the recording, within a second.
    ///
    /// Errors: [`VizError::Write`] if not everything could be written.
    pub(crate) fn finish(&mut self) -> Result<()> {
        self.flush()?;
        let Output::File { path, file, .. } = &mut self.output else { return Ok(()) };
        file.finish(PATIENCE).map_err(|ended| VizError::Write { path: path.clone(), ended })
    }

    fn send_chunk(&mut self, chunk: &Chunk) -> Result<()> {
        let sizes = [u64::try_from(chunk.num_rows()).unwrap_or(0), chunk.total_size_bytes()];
        let message = LogMsg::ArrowMsg(self.store.clone(), chunk.to_arrow_msg()?);
        let first = |timeline: &'static str| {
            chunk.timelines().get(&timeline.into()).map_or(0, |it| it.time_range().min().as_i64())
        };
        let at = (first(TIME), u32::try_from(first(LINE)).unwrap_or(0));
        self.pass_on(at, sizes, message);
        Ok(())
    }

    /// Passes on a message with its time and line, its number of rows and its size.
    fn pass_on(&mut self, at: (i64, u32), [records, bytes]: [u64; 2], data: LogMsg) {
        match &mut self.output {
            Output::Memory(messages) => messages.push(data),
            Output::File { file, patience, .. } => {
                let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
                file.send(Item { time_ns: at.0, line: at.1, bytes, records, data }, *patience);
            }
        }
    }
}

/// The file of a recording, which ends with a whole message also where the next one does not fit.
struct RecordingFile {
    path: PathBuf,
    file: File,
    encoder: Encoder<File>,
    bytes: u64,
}

impl RecordingFile {
    fn create(path: PathBuf) -> io::Result<Self> {
        let (file, options) = (File::create(&path)?, EncodingOptions::PROTOBUF_COMPRESSED);
        let encoder = Encoder::new_eager(CrateVersion::LOCAL, options, file.try_clone()?);
        let mut encoder = encoder.map_err(cause)?;
        // The index at the end of a file grows in memory with the recording, and its order is random.
        encoder.do_not_emit_footer();
        Ok(Self { path, bytes: file.metadata()?.len(), file, encoder })
    }
}

impl Sink<LogMsg> for RecordingFile {
    fn write(&mut self, message: LogMsg) -> io::Result<()> {
        self.bytes += self.encoder.append(&message).map_err(cause)?;
        Ok(())
    }

    fn finish(mut self) -> io::Result<()> {
        // The message `End` without an index: its kind and its length are 0.
        self.file.write_all(&[0; MessageHeader::ENCODED_SIZE_BYTES])?;
        let (written, named) = (self.file.metadata()?, std::fs::metadata(&self.path)?);
        if (named.dev(), named.ino()) == (written.dev(), written.ino()) {
            return Ok(());
        }
        Err(io::Error::new(io::ErrorKind::NotFound, "another file has its name now"))
    }

    fn cut(self) {
        // Why the file has ended matters more than what is left of a message.
        self.file.set_len(self.bytes).ok();
    }
}

/// The cause of an error, without rerun's words around it.
fn cause(error: EncodeError) -> io::Error {
    match error {
        EncodeError::Write(source) => source,
        other => io::Error::other(other),
    }
}
