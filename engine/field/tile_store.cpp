#include "engine/field/tile_store.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <new>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <unistd.h>

#include "engine/base/memory.h"

namespace fettle::engine {

namespace {

struct GuardedPolicy {
  std::mutex lock;
  StorePolicy policy;
};

GuardedPolicy& guardedPolicy() {
  static GuardedPolicy guarded;
  return guarded;
}

struct Folder {
  std::uint64_t free_bytes = 0;
  bool in_memory = false;
};

Result<Folder> statFolder(const std::string& folder) {
  struct statfs facts {};
  if (statfs(folder.c_str(), &facts) != 0)
    return inputError(fmt::format("no tiles can be kept there ({})", std::strerror(errno)), folder,
                      "name a folder on a disk with --store");
  Folder found;
  found.free_bytes = static_cast<std::uint64_t>(facts.f_bavail) * static_cast<std::uint64_t>(facts.f_frsize);
  found.in_memory = facts.f_type == TMPFS_MAGIC || facts.f_type == RAMFS_MAGIC;
  return found;
}

int openNameless(const std::string& folder) {
  int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return file;
  // A file system without unnamed files: with a name, removed immediately.
  std::string name = folder + "/fettle-tiles-XXXXXX";
  file = mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0) unlink(name.c_str());
  return file;
}

}  // namespace

Result<std::unique_ptr<TileStore>> TileStore::create(const std::string& folder, std::uint64_t at_least) {
  const auto facts = statFolder(folder);
  if (!facts) return tl::unexpected(facts.error());
  if (facts->in_memory)
    return inputError("tiles kept there would still be in memory", folder,
                      "name a folder on a disk with --store");
  if (facts->free_bytes < at_least)
    return inputError(fmt::format("the tiles need {} MB of the disk, {} MB are free", at_least >> 20,
                                  facts->free_bytes >> 20),
                      folder, "free space or name another folder with --store");
  const int file = openNameless(folder);
  if (file < 0)
    return inputError(fmt::format("no tiles can be kept there ({})", std::strerror(errno)), folder,
                      "name a folder that you may write to with --store");
  return std::unique_ptr<TileStore>(new TileStore(folder, file));
}

TileStore::~TileStore() {
  for (const Mapped& slab : slabs_) munmap(slab.at, slab.bytes);
  close(file_);
}

// Several slabs at a time: allocated one by one they would be fragmented on the disk.
bool TileStore::takeBlocks(std::uint64_t bytes) noexcept {
  constexpr std::uint64_t kAtOnce = std::uint64_t{64} << 20;
  for (const std::uint64_t amount : {std::max(bytes, kAtOnce), bytes}) {
    int problem = EINTR;
    while (problem == EINTR)
      problem = posix_fallocate(file_, static_cast<off_t>(reserved_), static_cast<off_t>(amount));
    if (problem != 0) continue;
    reserved_ += amount;
    return true;
  }
  return false;
}

void* TileStore::take(std::size_t bytes) noexcept {
  const std::scoped_lock guard(lock_);
  if (used_ + bytes > reserved_ && !takeBlocks(bytes)) return nullptr;
  try {
    slabs_.reserve(slabs_.size() + 1);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
  // Twice the size, to find a multiple of the size in it; the rest is unmapped.
  void* room = mmap(nullptr, 2 * bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) return nullptr;
  char* const begin = static_cast<char*>(room);
  const std::size_t before = (bytes - (reinterpret_cast<std::uintptr_t>(begin) & (bytes - 1))) & (bytes - 1);
  char* const slab = begin + before;
  if (before > 0) munmap(begin, before);
  munmap(slab + bytes, bytes - before);
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  constexpr int kAccess = PROT_READ | PROT_WRITE;
  if (mmap(slab, bytes, kAccess, MAP_SHARED | MAP_FIXED, file_, static_cast<off_t>(used_)) == MAP_FAILED ||
      mmap(slab, page, kAccess, MAP_PRIVATE | MAP_FIXED | MAP_ANONYMOUS, -1, 0) == MAP_FAILED) {
    munmap(slab, bytes);
    return nullptr;
  }
  // If the loop has locked all pages, those of the file must be unlocked.
  munlock(slab + page, bytes - page);
  slabs_.insert(std::ranges::upper_bound(slabs_, slab, {}, &Mapped::at), {slab, bytes});
  used_ += bytes;
  return slab;
}

void TileStore::unlock() noexcept {
  const std::scoped_lock guard(lock_);
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (const Mapped& slab : slabs_) munlock(slab.at + page, slab.bytes - page);
}

bool TileStore::holds(const void* address) const noexcept {
  const std::scoped_lock guard(lock_);
  const auto* at = static_cast<const char*>(address);
  const auto above = std::ranges::upper_bound(
      slabs_, at, [](const char* a, const char* b) { return a < b; }, &Mapped::at);
  return above != slabs_.begin() && at < std::prev(above)->at + std::prev(above)->bytes;
}

std::uint64_t TileStore::bytes() const noexcept {
  const std::scoped_lock guard(lock_);
  return reserved_;
}

void setStorePolicy(const StorePolicy& policy) {
  GuardedPolicy& guarded = guardedPolicy();
  const std::scoped_lock guard(guarded.lock);
  guarded.policy = policy;
}

StorePolicy storePolicy() {
  GuardedPolicy& guarded = guardedPolicy();
  const std::scoped_lock guard(guarded.lock);
  return guarded.policy;
}

std::uint64_t fieldBytes(std::uint64_t width, std::uint64_t height) noexcept {
  // Tiles contain marks and bounds, and a share of a node: 1.07 times the samples' 4 bytes.
  const std::uint64_t tiles = (width + kTileSide - 1) / kTileSide * ((height + kTileSide - 1) / kTileSide);
  return tiles * (sizeof(Tile) + 96);
}

Result<Place> placeOf(std::uint64_t width, std::uint64_t height, std::uint64_t extra_bytes,
                      const std::string& what) {
  const StorePolicy policy = storePolicy();
  const std::uint64_t bytes = fieldBytes(width, height);
  const std::uint64_t available = availableMemory();
  const auto comfortable = static_cast<std::uint64_t>(policy.share * static_cast<double>(available));
  if (!policy.always && (available == 0 || bytes <= comfortable)) return Place::kMemory;

  // Nodes, counters and the builder's notes stay in memory: a sixtieth of the tiles.
  const bool enough_memory = available == 0 || extra_bytes + bytes / 60 <= available;
  const auto disk = statFolder(policy.folder);
  // Not to the last block: other programs write there too.
  if (enough_memory && disk && !disk->in_memory && bytes <= disk->free_bytes / 10 * 9) return Place::kStore;
  if (policy.always && !disk) return tl::unexpected(disk.error());
  if (!policy.always && bytes + extra_bytes <= available) return Place::kMemory;
  return inputError(fmt::format("{} x {} samples need {} MB of memory, {} MB are free, nor are there as many "
                                "on the disk of {}",
                                width, height, (bytes + extra_bytes) >> 20, available >> 20, policy.folder),
                    what, "cut the scan into parts, close other programs or name a folder with --store");
}

Result<std::shared_ptr<FieldMemory>> memoryFor(std::uint64_t width, std::uint64_t height,
                                               const std::string& what) {
  // Small ones always, without a system call: tests and pieces of scans are made by thousands.
  constexpr std::uint64_t kSmall = std::uint64_t{64} << 20;
  if (!storePolicy().always && fieldBytes(width, height) <= kSmall) return std::make_shared<FieldMemory>();
  const auto place = placeOf(width, height, 0, what);
  if (!place) return tl::unexpected(place.error());
  if (*place == Place::kMemory) return std::make_shared<FieldMemory>();
  auto store = TileStore::create(storePolicy().folder, fieldBytes(width, height));
  if (!store) return tl::unexpected(store.error());
  return std::make_shared<FieldMemory>(*std::move(store));
}

}  // namespace fettle::engine
