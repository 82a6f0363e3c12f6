#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/node_pool.h"

namespace fettle::engine {

/// Slabs of tiles in a mapped file, for fields larger than memory: the system writes out pages that are not
/// used and reads them again on demand. The file has no name and is freed with the process, however that
/// ends.
///
/// Disk blocks are allocated before an address is returned, so on a full disk take() returns null and a write
/// never raises a signal. A disk that fails while a tile is read does end the process.
/// The first page of each slab - the counters of its tiles - is ordinary memory: acquiring, sharing and
/// returning tiles never waits for the disk.
///
/// Threading: any thread, locked.
class TileStore final : public SlabSource {
 public:
  /// In `folder`, which must have `at_least` bytes free. Errors (kInput): no such folder, not writable, its
  /// files lie in memory, not enough space.
  [[nodiscard]] static Result<std::unique_ptr<TileStore>> create(const std::string& folder,
                                                                 std::uint64_t at_least);
  ~TileStore() override;
  TileStore& operator=(TileStore&&) = delete;

  [[nodiscard]] void* take(std::size_t bytes) noexcept override;

  /// Unlocks every page, after mlockall locked them: the system must be able to write them out.
  void unlock() noexcept;

  /// Whether an address lies in a slab of this store.
  [[nodiscard]] bool holds(const void* address) const noexcept;

  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }
  /// Disk space allocated [bytes].
  [[nodiscard]] std::uint64_t bytes() const noexcept;

 private:
  TileStore(std::string folder, int file) : folder_(std::move(folder)), file_(file) {}
  [[nodiscard]] bool takeBlocks(std::uint64_t bytes) noexcept;

  struct Mapped {
    char* at;
    std::size_t bytes;
  };
  std::string folder_;
  int file_;
  mutable std::mutex lock_;
  std::vector<Mapped> slabs_;   // by address; guarded by lock_
  std::uint64_t used_ = 0;      // guarded by lock_
  std::uint64_t reserved_ = 0;  // guarded by lock_
};

/// Which fields lie in a store.
struct StorePolicy {
  /// Folder of the store; on a disk with enough space.
  std::string folder = "/var/tmp";
  /// Every field, not only those above `share`.
  bool always = false;
  /// Share of the available memory that a field may take before it goes into a store, 0 .. 1. Half: a
  /// filter's result is as large as the field.
  double share = 0.5;
};

/// The policy of this process. Set before fields are opened; any thread.
void setStorePolicy(const StorePolicy& policy);
[[nodiscard]] StorePolicy storePolicy();

/// Memory of a field, tiles full at its borders too [bytes].
[[nodiscard]] std::uint64_t fieldBytes(std::uint64_t width, std::uint64_t height) noexcept;

/// Whether a field can be held, and where: in ordinary memory or in a store, according to the policy.
/// `extra_bytes` of memory are needed in addition. `what` names the field in the error. Errors (kInput): not
/// enough space in either. Nothing is allocated.
enum class Place : std::uint8_t { kMemory, kStore };
[[nodiscard]] Result<Place> placeOf(std::uint64_t width, std::uint64_t height, std::uint64_t extra_bytes,
                                    const std::string& what);

/// The memory that placeOf names. Errors: as placeOf, as TileStore::create.
[[nodiscard]] Result<std::shared_ptr<FieldMemory>> memoryFor(std::uint64_t width, std::uint64_t height,
                                                             const std::string& what);

}  // namespace fettle::engine
