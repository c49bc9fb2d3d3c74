//! Input within limits: whole files and lines of streams, with one message for what is too long.
//!
//! ```
//! use twin_files::limited_read;
//!
//! assert_eq!(limited_read::all_of(&b"G1 X1"[..], 5)?, b"G1 X1");
//! let error = limited_read::all_of(&b"G1 X10"[..], 5).unwrap_err();
//! assert!(error.to_string().starts_with("it has more than 5 bytes, the most that are read"));
//! # Ok::<(), std::io::Error>(())
//! ```

pub mod limited_read;
pub mod text;
