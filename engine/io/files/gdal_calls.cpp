#include "engine/io/files/gdal_calls.h"

#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/loaded_library.h"

#if GDAL_VERSION_MAJOR != 3 || GDAL_VERSION_MINOR != 6
#error "the number of the library below is that of GDAL 3.6: give that of the GDAL that this is built with"
#endif

namespace fettle::engine {

namespace {

GdalCalls loaded() {
  GdalCalls calls;
  LoadedLibrary library("libgdal.so.32", "libgdal32");
#define FETTLE_CALL(name) library.find(#name, calls.name);
  FETTLE_GDAL_CALLS(FETTLE_CALL)
  FETTLE_GDAL_DRIVERS(FETTLE_CALL)
#undef FETTLE_CALL
  if (const auto status = library.status("files cannot be read and written by GDAL", "GDAL", ""); !status)
    throw std::runtime_error(fmt::format("{}, {}", status.error().what, status.error().remedy));
  return calls;
}

}  // namespace

const GdalCalls& gdal() {
  static const GdalCalls calls = loaded();
  return calls;
}

}  // namespace fettle::engine
