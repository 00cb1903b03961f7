"""Random steps with files, in the working directory; prints what each of them says. argv: seed, number of steps."""
import glob, os, pathlib, random, shutil, stat, sys

rng = random.Random(int(sys.argv[1]))
NAMES = ["a", "b", "d", "d/a", "d/e", "d/e/a", "./a", "d/../b", "x/y", "名", "a/b", ""]
SEEN = [*NAMES, ".", "..", "d/", "a/", "./d/.", "d/e/..", "a/..", "../ros2_ws/b"]
MODES = ["r", "w", "a", "x", "r+", "w+", "a+", "x+", "rb", "wb", "ab", "rb+", "wb+", "ab+", "rw", "", "z", "bt"]
FLAGS = [os.O_RDONLY, os.O_WRONLY, os.O_RDWR, os.O_WRONLY | os.O_CREAT, os.O_RDWR | os.O_CREAT | os.O_EXCL,
         os.O_RDWR | os.O_CREAT | os.O_TRUNC, os.O_RDWR | os.O_APPEND]


def name():
    return rng.choice(NAMES)


def use(file):
    with file:
        said = [file.mode, file.name, file.readable(), file.writable(), file.seekable(), file.isatty()]
        for _ in range(rng.randrange(6)):
            step = rng.randrange(7)
            binary = "b" in file.mode
            try:
                if step == 0:
                    data = "línea\n" * rng.randrange(4)
                    said.append(file.write(data.encode() if binary else data))
                elif step == 1:
                    said.append(file.read(rng.randrange(-1, 9)))
                elif step == 2:
                    said.append(file.seek(0, rng.randrange(3)))
                elif step == 3:
                    said.append(file.tell())
                elif step == 4:
                    said.append(file.truncate(rng.choice([None, 0, 3, 20])))
                elif step == 5:
                    said.append(file.readline())
                else:
                    said.append(file.flush())
            except (OSError, ValueError) as error:
                said.append((type(error).__name__, str(error)))
        return said


def opened():
    path, mode, buffering = name(), rng.choice(MODES), rng.choice([-1, -1, -1, 0, 16])
    kind = rng.randrange(3)
    if kind == 0:
        return use(open(path, mode, buffering))
    if kind == 1:
        return use(pathlib.Path(path).open(mode, buffering))
    return use(open(path, mode, buffering, encoding=rng.choice([None, "utf-8"]), newline=rng.choice([None, "", "\n"])))


def low():
    path = name()
    if os.path.isdir(path):
        return None
    fd = os.open(path, rng.choice(FLAGS))
    said = []
    try:
        for _ in range(rng.randrange(6)):
            step = rng.randrange(5)
            try:
                if step == 0:
                    said.append(os.write(fd, b"xyz"))
                elif step == 1:
                    said.append(os.read(fd, 5))
                elif step == 2:
                    said.append(os.lseek(fd, rng.randrange(-1, 4), rng.randrange(3)))
                elif step == 3:
                    said.append(os.fstat(fd).st_size)
                else:
                    said.append((os.fsync(fd), os.isatty(fd)))
            except OSError as error:
                said.append(str(error))
    finally:
        os.close(fd)
    return said


def status(path):
    found = os.stat(path)
    kind = "dir" if stat.S_ISDIR(found.st_mode) else found.st_size
    return kind, oct(found.st_mode)


def walked():
    return sorted((root, sorted(folders), sorted(files)) for root, folders, files in os.walk("."))


def scanned(path):
    with os.scandir(path) as entries:
        return sorted((e.name, e.path, e.is_dir(), e.is_file(), e.is_symlink(), e.stat().st_mode) for e in entries)


ACTIONS = [
    opened, opened, opened, opened, low, low, walked,
    lambda: os.mkdir(name()),
    lambda: os.mkdir(name(), 0o700),
    lambda: os.makedirs(name(), exist_ok=rng.random() < 0.5),
    lambda: os.rmdir(name()),
    lambda: os.remove(name()),
    lambda: os.unlink(name()),
    lambda: os.rename(name(), name()),
    lambda: os.replace(name(), name()),
    lambda: sorted(os.listdir(name())),
    lambda: sorted(os.listdir(os.fsencode(name()))),
    lambda: scanned(name()),
    lambda: status(name()),
    lambda: os.chmod(name(), 0o640),
    lambda: oct(os.umask(rng.choice([0o022, 0o027, 0o002]))),
    lambda: os.utime(rng.choice(["a", "b", "d/a", "a/b"]), (5, 7)),
    lambda: os.utime("student.py", (5, 7)) or os.path.getmtime("student.py"),
    lambda: [os.path.exists(n) for n in SEEN],
    lambda: [(os.path.isfile(n), os.path.isdir(n), os.path.islink(n), os.access(n, os.R_OK)) for n in SEEN],
    lambda: shutil.copy(name(), name()),
    lambda: shutil.copy2(name(), name()),
    lambda: shutil.copytree(rng.choice(["d", "a", "d/e"]), "copy" + str(rng.randrange(3)), dirs_exist_ok=True),
    lambda: shutil.rmtree(rng.choice(["d", "copy0", "copy1", "a"])),
    lambda: shutil.move(name(), name()),
    lambda: pathlib.Path(name()).touch(exist_ok=rng.random() < 0.5),
    lambda: pathlib.Path(name()).unlink(missing_ok=rng.random() < 0.5),
    lambda: pathlib.Path(name()).write_text("héllo"),
    lambda: pathlib.Path(name()).read_bytes(),
    lambda: sorted(map(str, pathlib.Path(".").rglob("*"))),
    lambda: sorted(glob.glob("**/*", recursive=True)),
    lambda: os.readlink(name()),
    lambda: os.path.samefile(name(), name()),
    lambda: os.path.getsize(name()),
]
for number in range(int(sys.argv[2])):
    action = rng.choice(ACTIONS)
    try:
        said = action()
    except shutil.Error as error:
        said = type(error).__name__
    except (OSError, ValueError) as error:
        said = type(error).__name__, str(error), getattr(error, "errno", 0)
    print(number, getattr(action, "__name__", ""), said)
