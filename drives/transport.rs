//! Byte stream to a device.

use tokio::io::{AsyncRead, AsyncWrite};

/// A stream of bytes to a device: a serial port, a pseudo-terminal, memory.
pub trait Transport: AsyncRead + AsyncWrite + Unpin + Send {}

impl<T: AsyncRead + AsyncWrite + Unpin + Send> Transport for T {}
