//! Pseudo-terminals: a serial port without hardware for an emulated device.
//!
//! A pseudo-terminal keeps the speed that its master has set and goes at none: [`AtSpeed`] makes a device deaf to masters
//! at another speed. Parity is not kept (Linux sets 8 bits without parity whatever is asked for), so it is unknown.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io,
    os::unix::fs::{MetadataExt, symlink},
    path::{Path, PathBuf},
    pin::Pin,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    task::{Context, Poll, ready},
};

use serialport::{SerialPort, TTYPort};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

use crate::EmulatorError;

/// The far end of a pseudo-terminal: where the driver, or any other program, opens the emulated device.
///
/// The slave side stays open here as long as the value lives: a master whose slave nobody holds reads EIO. It is
/// opened without a lock, so that others can open its path; both sides are raw.
#[derive(Debug)]
pub struct PseudoTerminal {
    path: PathBuf,
    #[expect(dead_code, reason = "it goes with the terminal")]
    link: Option<Link>,
    keeper: TTYPort,
}

impl PseudoTerminal {
    /// Opens a pair and gives the near end (master) with it. `link`, if any, becomes a symbolic link to the far end;
    /// one there that leads nowhere, or was made for a terminal that has gone, is replaced, but never that of an emulator
    /// that lives: it keeps a lock on a file next to it.
    ///
    /// # Errors
    /// If the system gives no pseudo-terminal, or the link cannot be made or is in use.
    pub fn open(link: Option<&Path>) -> Result<(TTYPort, Self), EmulatorError> {
        let terminal = |source: io::Error| EmulatorError::Terminal { source };
        // pair() gives (master, slave).
        let (master, keeper) = TTYPort::pair().map_err(|error| terminal(error.into()))?;
        let path = keeper
            .name()
            .map(PathBuf::from)
            .ok_or_else(|| terminal(io::ErrorKind::NotFound.into()))?;
        let link = link.map(|link| Link::make(&path, link)).transpose()?;
        Ok((master, Self { path, link, keeper }))
    }

    /// The near end for a device that speaks at `baud`, which is also the speed of masters that set none. With `any`
    /// speed it understands all masters.
    ///
    /// The device may change its speed later; the terminal keeps that of its master, as a port does.
    ///
    /// # Errors
    /// If the terminal takes no speed.
    pub fn at_speed<S>(
        &mut self,
        stream: S,
        baud: &DeviceSpeed,
        any: bool,
    ) -> Result<AtSpeed<S>, EmulatorError> {
        let terminal = |error: serialport::Error| EmulatorError::Terminal { source: error.into() };
        self.keeper.set_baud_rate(baud.get()).map_err(terminal)?;
        let far = self.keeper.try_clone_native().map_err(terminal)?;
        Ok(AtSpeed { stream, far, baud: (!any).then(|| baud.clone()) })
    }

    /// Path of the far end.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// A symbolic link to the far end, and the lock that says that its emulator lives.
#[derive(Debug)]
struct Link {
    path: PathBuf,
    target: PathBuf,
    /// Next to the link.
    lock_path: PathBuf,
    /// The system frees it when the program ends, however it does.
    #[expect(dead_code, reason = "its lock is what counts")]
    lock: File,
}

impl Link {
    fn make(target: &Path, link: &Path) -> Result<Self, EmulatorError> {
        let failed = |source| EmulatorError::Link { path: link.to_path_buf(), source };
        let mut name = link.file_name().unwrap_or_default().to_owned();
        name.push(".emulator");
        let lock_path = link.with_file_name(name);
        let lock = loop {
            let open = OpenOptions::new().write(true).create(true).truncate(false).open(&lock_path);
            let lock = open.map_err(failed)?;
            match lock.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(EmulatorError::LinkTaken { path: link.to_path_buf() });
                }
                Err(TryLockError::Error(source)) => return Err(failed(source)),
            }
            // The one before may have removed the file since it was opened: then nobody else sees this lock.
            let own = lock.metadata().map_err(failed)?.ino();
            if fs::metadata(&lock_path).is_ok_and(|there| there.ino() == own) {
                break lock;
            }
        };
        let link = Self { path: link.to_path_buf(), target: target.to_path_buf(), lock_path, lock };
        make_link(target, &link.path)?;
        Ok(link)
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // Another program may have put its own there since. Nothing can be done about one that does not go; it leads nowhere
        // now.
        if fs::read_link(&self.path).is_ok_and(|target| target == self.target) {
            drop(fs::remove_file(&self.path));
        }
        drop(fs::remove_file(&self.lock_path));
    }
}

/// The speed of a device, bits per second: its terminal goes by it, and the device changes it.
#[derive(Clone, Debug)]
pub struct DeviceSpeed(Arc<AtomicU32>);

impl DeviceSpeed {
    /// Of a device at power-up.
    pub fn new(baud: u32) -> Self {
        Self(Arc::new(AtomicU32::new(baud)))
    }

    /// The device speaks at another from now on.
    pub fn set(&self, baud: u32) {
        self.0.store(baud, Ordering::Relaxed);
    }

    fn get(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}

/// The near end of a pseudo-terminal whose device understands one speed only: what a master sends at another is noise to
/// it, of which a frame's check leaves nothing.
#[derive(Debug)]
pub struct AtSpeed<S> {
    stream: S,
    far: TTYPort,
    /// None if all are understood.
    baud: Option<DeviceSpeed>,
}

impl<S> AtSpeed<S> {
    /// Whether the master speaks as the device does; one of unknown speed does.
    fn understands(&self) -> bool {
        let Some(baud) = &self.baud else { return true };
        self.far.baud_rate().map_or(true, |set| set == baud.get())
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for AtSpeed<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buf: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buf.filled().len();
        loop {
            ready!(Pin::new(&mut self.stream).poll_read(cx, buf))?;
            // Nothing read is the end of the stream.
            if buf.filled().len() == before || self.understands() {
                return Poll::Ready(Ok(()));
            }
            buf.set_filled(before);
        }
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for AtSpeed<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

/// Whether a link was made for a terminal that has gone: it leads nowhere, or to a terminal that is younger than the
/// link, because numbers of terminals are given anew – perhaps that of the one the link is now wanted for.
fn is_left_behind(link: &Path, own: &Path) -> bool {
    let Ok(target) = fs::metadata(link) else { return true };
    if fs::canonicalize(link).is_ok_and(|target| target == own) {
        return true;
    }
    let made = |of: &fs::Metadata| (of.ctime(), of.ctime_nsec());
    fs::symlink_metadata(link).is_ok_and(|link| made(&target) > made(&link))
}

fn make_link(path: &Path, link: &Path) -> Result<(), EmulatorError> {
    let failed = |source| EmulatorError::Link { path: link.to_path_buf(), source };
    match fs::symlink_metadata(link) {
        // Left by an emulator that could not clean up.
        Ok(metadata) if metadata.is_symlink() && is_left_behind(link, path) => {
            fs::remove_file(link).map_err(failed)?;
        }
        Ok(_) => return Err(EmulatorError::LinkTaken { path: link.to_path_buf() }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(failed(error)),
    }
    symlink(path, link).map_err(failed)
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};

    use super::*;

    #[test]
    fn bytes_pass_raw_and_the_slave_can_be_opened_again_and_again() {
        let (mut master, far) = PseudoTerminal::open(None).unwrap();
        for _ in 0..2 {
            let name = far.path().to_str().unwrap();
            let mut peer = TTYPort::open(&serialport::new(name, 115_200)).unwrap();
            // Bytes a terminal in its usual mode would translate, echo or take for signals.
            let bytes = [0x0D, 0x0A, 0x03, 0x04, 0x11, 0x13, 0x1A, 0xFF, 0x00];
            peer.write_all(&bytes).unwrap();
            let mut received = [0; 9];
            master.read_exact(&mut received).unwrap();
            assert_eq!(received, bytes);
            master.write_all(&bytes).unwrap();
            let mut received = [0; 9];
            peer.read_exact(&mut received).unwrap();
            assert_eq!(received, bytes);
        }
    }

    #[test]
    fn the_link_leads_to_the_slave_and_goes_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        let (_first, first) = PseudoTerminal::open(Some(&link)).unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), first.path());
        // A second emulator does not take it away.
        let refused = PseudoTerminal::open(Some(&link));
        assert!(matches!(refused, Err(EmulatorError::LinkTaken { .. })));
        assert_eq!(fs::read_link(&link).unwrap(), first.path());
        drop(first);
        assert!(fs::symlink_metadata(&link).is_err());
        // What one leaves behind that could not clean up is replaced.
        symlink("/dev/pts/no such terminal", &link).unwrap();
        let (_third, third) = PseudoTerminal::open(Some(&link)).unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), third.path());
    }

    /// That somebody changes the rights of its terminal makes an emulator no younger.
    #[test]
    fn the_link_of_an_emulator_that_lives_is_not_taken() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        let (_first, first) = PseudoTerminal::open(Some(&link)).unwrap();
        // Timestamps go by ticks of the kernel.
        std::thread::sleep(std::time::Duration::from_millis(50));
        fs::set_permissions(first.path(), fs::Permissions::from_mode(0o620)).unwrap();
        let refused = PseudoTerminal::open(Some(&link));
        assert!(matches!(refused, Err(EmulatorError::LinkTaken { .. })));
        assert_eq!(fs::read_link(&link).unwrap(), first.path());
        drop(first);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "something stays behind");
    }

    #[test]
    fn a_link_whose_terminal_has_gone_is_replaced_though_its_number_is_in_use_again() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        // Made before the terminal it leads to, as a link is that was left behind.
        let terminal = PseudoTerminal::open(None).unwrap();
        let number = terminal.1.path().to_path_buf();
        drop(terminal);
        symlink(&number, &link).unwrap();
        // Timestamps go by ticks of the kernel.
        std::thread::sleep(std::time::Duration::from_millis(50));
        // Somebody else, or the very terminal that the link is wanted for, has that number now.
        let mut held = Vec::new();
        while !number.exists() {
            held.push(PseudoTerminal::open(None).unwrap());
        }
        let (_new, new) = PseudoTerminal::open(Some(&link)).unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), new.path());
        // Of its own number.
        let (_own, own) = PseudoTerminal::open(None).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        symlink(own.path(), &link).unwrap();
        make_link(own.path(), &link).unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), own.path());
    }

    #[tokio::test]
    async fn what_comes_at_another_speed_is_not_understood() {
        use tokio::io::AsyncReadExt;
        for (any, heard) in [(false, "fast"), (true, "slowfast")] {
            let (master, mut far) = PseudoTerminal::open(None).unwrap();
            let stream = tokio_serial::SerialStream::try_from(master).unwrap();
            let mut near = far.at_speed(stream, &DeviceSpeed::new(115_200), any).unwrap();
            let mut received = vec![0; heard.len()];
            let name = far.path().to_str().unwrap().to_owned();
            let read = near.read_exact(&mut received);
            let sent = async {
                for (baud, text) in [(9600, "slow"), (115_200, "fast")] {
                    let mut peer = TTYPort::open(&serialport::new(&name, baud)).unwrap();
                    peer.write_all(text.as_bytes()).unwrap();
                    // Until it is read: a speed is that of all bytes on their way.
                    tokio::time::sleep(std::time::Duration::from_millis(50)).await;
                }
            };
            let (read, ()) = tokio::join!(read, sent);
            read.unwrap();
            assert_eq!(received, heard.as_bytes());
        }
    }

    #[test]
    fn a_file_in_the_place_of_the_link_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        fs::write(&link, "precious").unwrap();
        let refused = PseudoTerminal::open(Some(&link));
        assert!(matches!(refused, Err(EmulatorError::LinkTaken { .. })));
        assert_eq!(fs::read_to_string(&link).unwrap(), "precious");
    }
}
