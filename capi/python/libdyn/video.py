"""Videos: pictures to a file by ffmpeg, of the system or of the package imageio-ffmpeg."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from typing import TYPE_CHECKING, Any

from .errors import ArgumentError, FileError, SizeError, UnsupportedError

if TYPE_CHECKING:
    from .picture import Image


def ffmpeg() -> str:
    """The program ffmpeg."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        import imageio_ffmpeg  # type: ignore[import-not-found, import-untyped, unused-ignore]

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise UnsupportedError("a video needs ffmpeg: pip install imageio-ffmpeg, or install ffmpeg.") from None


class Video:
    """A video file that is being written, H.264 in whatever its name says (.mp4, .mkv).

        with Video("run.mp4", 640, 480, fps=30) as video:
            video.add(picture)                     # (480, 640, 3), uint8
    """

    path: str

    def __init__(self, path: str | os.PathLike[str], width: int, height: int, fps: float = 30.0):
        if not 0 < fps <= 1000:
            raise ArgumentError(f"fps is {fps}, but must be more than 0, at most 1000.")
        self.path, self._shape = os.fspath(path), (height, width, 3)
        self._said = tempfile.TemporaryFile()  # a pipe that nobody reads would stop it
        words = [ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r",
                 f"{fps}", "-i", "-", "-an", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-crf", "20", "-pix_fmt",
                 "yuv420p", "-movflags", "+faststart", os.path.abspath(self.path)]
        self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._said)

    def __enter__(self) -> Video:
        return self

    def __exit__(self, kind: Any, *_: Any) -> None:
        self.close(kind is None)

    def add(self, picture: Image) -> None:
        """The next picture."""
        if picture.shape != self._shape or picture.dtype.name != "uint8":
            raise SizeError(f"the picture is {picture.dtype} of shape {picture.shape}, but must be uint8 of shape {self._shape}.")
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(picture.tobytes())
        except OSError:
            self.close()

    def close(self, check: bool = True) -> None:
        """Ends the file. check: an error of ffmpeg is raised."""
        stdin = self._process.stdin
        if stdin is not None and not stdin.closed:
            try:
                stdin.close()
            except OSError:
                pass  # it has ended, and says why
        if self._process.wait() and check and not self._said.closed:
            self._said.seek(0)
            said = self._said.read().decode(errors="replace").strip()
            self._said.close()
            raise FileError(f"ffmpeg could not write {self.path}: {said.splitlines()[-1] if said else 'it does not say why'}.")
        self._said.close()
