#include "app/work/memory_places.h"

#include <cassert>

namespace fettle::app {

namespace {

// Commands take paths as texts and pass them from function to function: a parameter for names in memory would have to
// go the same ways. Thread-local, so that several commands run at the same time.
thread_local MemoryPlaces* thread_places = nullptr;

}  // namespace

MemoryPlaces::MemoryPlaces() {
  assert(thread_places == nullptr);
  thread_places = this;
}

MemoryPlaces::~MemoryPlaces() {
  thread_places = nullptr;
}

MemoryPlace* MemoryPlaces::find(const std::string& name) {
  const auto found = places_.find(name);
  return found == places_.end() ? nullptr : &found->second;
}

MemoryPlace* memoryPlace(const std::string& path) {
  return thread_places == nullptr ? nullptr : thread_places->find(path);
}

}  // namespace fettle::app
