#include "tests/engine/session/faulty_disk.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include <sqlite3.h>
#include <unistd.h>

namespace fettle::engine {

namespace {

// What a write or truncation since the last flush replaced.
struct Replaced {
  sqlite3_int64 offset = 0;
  std::string bytes;  // at offset, as they were; shorter than what was written at the end of the file
  sqlite3_int64 file_size = 0;  // before it
};

struct State {
  std::mutex lock;
  std::int64_t operations = 0;
  std::int64_t fail_at = std::numeric_limits<std::int64_t>::max();
  bool once = false;
  bool struck = false;
  std::map<std::string, std::vector<Replaced>> unflushed;  // by path
};
State state;
sqlite3_vfs* real_vfs = nullptr;

struct File {
  sqlite3_file base;
  sqlite3_file* real;
  std::string* path;
};

File* self(sqlite3_file* file) {
  return reinterpret_cast<File*>(file);
}
sqlite3_file* real(sqlite3_file* file) {
  return self(file)->real;
}

// Counts an operation; true when it is to fail. The caller holds the lock.
bool fails() {
  const std::int64_t n = ++state.operations;
  const bool now = state.once ? n == state.fail_at : n >= state.fail_at;
  state.struck = state.struck || now;
  return now;
}

void remember(sqlite3_file* file, sqlite3_int64 offset, sqlite3_int64 length) {
  Replaced replaced;
  replaced.offset = offset;
  real(file)->pMethods->xFileSize(real(file), &replaced.file_size);
  const sqlite3_int64 there = std::clamp<sqlite3_int64>(replaced.file_size - offset, 0, length);
  replaced.bytes.resize(static_cast<std::size_t>(there));
  if (there > 0)
    real(file)->pMethods->xRead(real(file), replaced.bytes.data(), static_cast<int>(there), offset);
  state.unflushed[*self(file)->path].push_back(std::move(replaced));
}

int closeFile(sqlite3_file* file) {
  const int code = real(file)->pMethods->xClose(real(file));
  delete self(file)->path;
  sqlite3_free(real(file));
  return code;
}
int readFile(sqlite3_file* f, void* to, int n, sqlite3_int64 at) {
  return real(f)->pMethods->xRead(real(f), to, n, at);
}
int writeFile(sqlite3_file* f, const void* from, int n, sqlite3_int64 at) {
  const std::scoped_lock lock(state.lock);
  if (fails()) return SQLITE_FULL;
  remember(f, at, n);
  return real(f)->pMethods->xWrite(real(f), from, n, at);
}
int truncateFile(sqlite3_file* f, sqlite3_int64 size) {
  const std::scoped_lock lock(state.lock);
  if (fails()) return SQLITE_IOERR_TRUNCATE;
  remember(f, size, std::numeric_limits<int>::max());
  return real(f)->pMethods->xTruncate(real(f), size);
}
int syncFile(sqlite3_file* f, int flags) {
  const std::scoped_lock lock(state.lock);
  if (fails()) return SQLITE_IOERR_FSYNC;
  state.unflushed.erase(*self(f)->path);
  return real(f)->pMethods->xSync(real(f), flags);
}
int sizeOfFile(sqlite3_file* f, sqlite3_int64* size) {
  return real(f)->pMethods->xFileSize(real(f), size);
}
int lockFile(sqlite3_file* f, int level) {
  return real(f)->pMethods->xLock(real(f), level);
}
int unlockFile(sqlite3_file* f, int level) {
  return real(f)->pMethods->xUnlock(real(f), level);
}
int checkLock(sqlite3_file* f, int* out) {
  return real(f)->pMethods->xCheckReservedLock(real(f), out);
}
int control(sqlite3_file* f, int op, void* argument) {
  return real(f)->pMethods->xFileControl(real(f), op, argument);
}
int sectorSize(sqlite3_file* f) {
  return real(f)->pMethods->xSectorSize(real(f));
}
int characteristics(sqlite3_file* f) {
  return real(f)->pMethods->xDeviceCharacteristics(real(f));
}
int shmMap(sqlite3_file* f, int page, int size, int extend, void volatile** out) {
  return real(f)->pMethods->xShmMap(real(f), page, size, extend, out);
}
int shmLock(sqlite3_file* f, int offset, int n, int flags) {
  return real(f)->pMethods->xShmLock(real(f), offset, n, flags);
}
void shmBarrier(sqlite3_file* f) {
  real(f)->pMethods->xShmBarrier(real(f));
}
int shmUnmap(sqlite3_file* f, int remove) {
  return real(f)->pMethods->xShmUnmap(real(f), remove);
}

const sqlite3_io_methods kMethods{2,          closeFile,  readFile,        writeFile,  truncateFile,
                                  syncFile,   sizeOfFile, lockFile,        unlockFile, checkLock,
                                  control,    sectorSize, characteristics, shmMap,     shmLock,
                                  shmBarrier, shmUnmap,   nullptr,         nullptr};

int openFile(sqlite3_vfs*, sqlite3_filename name, sqlite3_file* file, int flags, int* out_flags) {
  File* wrapped = self(file);
  wrapped->base.pMethods = nullptr;
  wrapped->real = static_cast<sqlite3_file*>(sqlite3_malloc(real_vfs->szOsFile));
  if (wrapped->real == nullptr) return SQLITE_NOMEM;
  const int code = real_vfs->xOpen(real_vfs, name, wrapped->real, flags, out_flags);
  if (code != SQLITE_OK) {
    sqlite3_free(wrapped->real);
    return code;
  }
  wrapped->path = new std::string(name == nullptr ? "" : name);
  wrapped->base.pMethods = &kMethods;
  return SQLITE_OK;
}

int deleteFile(sqlite3_vfs*, const char* name, int sync) {
  const std::scoped_lock lock(state.lock);
  if (fails()) return SQLITE_IOERR_DELETE;
  state.unflushed.erase(name);
  return real_vfs->xDelete(real_vfs, name, sync);
}

sqlite3_vfs faulty_vfs;

}  // namespace

FaultyDisk::FaultyDisk() {
  real_vfs = sqlite3_vfs_find(nullptr);
  faulty_vfs = *real_vfs;
  faulty_vfs.zName = "faulty";
  faulty_vfs.szOsFile = sizeof(File);
  faulty_vfs.xOpen = openFile;
  faulty_vfs.xDelete = deleteFile;
  heal();
  state.unflushed.clear();
  sqlite3_vfs_register(&faulty_vfs, 1);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(&faulty_vfs);
  sqlite3_vfs_register(real_vfs, 1);
}

void FaultyDisk::failAt(std::int64_t n, Fault fault) {
  const std::scoped_lock lock(state.lock);
  state.operations = 0;
  state.fail_at = n;
  state.once = fault == Fault::kOnce;
  state.struck = false;
}

void FaultyDisk::heal() {
  failAt(std::numeric_limits<std::int64_t>::max(), Fault::kOnce);
}

std::int64_t FaultyDisk::operations() const {
  const std::scoped_lock lock(state.lock);
  return state.operations;
}

bool FaultyDisk::struck() const {
  const std::scoped_lock lock(state.lock);
  return state.struck;
}

void FaultyDisk::cutPower(int keep_of_256, std::uint64_t seed) {
  const std::scoped_lock lock(state.lock);
  state.fail_at = 0;
  state.once = false;
  std::mt19937_64 random(seed);
  for (auto& [path, writes] : state.unflushed) {
    for (auto write = writes.rbegin(); write != writes.rend(); ++write) {
      if (static_cast<int>(random() % 256) < keep_of_256) continue;
      {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        if (!file) break;
        file.seekp(write->offset);
        file.write(write->bytes.data(), static_cast<std::streamsize>(write->bytes.size()));
      }
      if (keep_of_256 == 0 && truncate(path.c_str(), write->file_size) != 0) break;
    }
  }
  state.unflushed.clear();
}

}  // namespace fettle::engine
