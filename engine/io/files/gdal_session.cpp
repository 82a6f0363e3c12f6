#include "engine/io/files/gdal_session.h"

#include <cerrno>

#include <atomic>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_calls.h"

namespace fettle::engine {

namespace {

void setUp() {
  // Each driver by its own registration: GDALAllRegister would load plugins and enable 200 formats, some of
  // which read any path or address that a file names.
  gdal().CPLSetConfigOption("GDAL_PAM_ENABLED",
                            "NO");  // no .aux.xml next to the user's file, read or written
  gdal().CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "TRUE");
  gdal().CPLSetConfigOption("GTIFF_IGNORE_READ_ERRORS", "NO");
  gdal().CPLSetConfigOption("CPL_DEBUG", "OFF");
  gdal().GDALSetCacheMax64(GIntBig{64} << 20);
  gdal().GDALRegister_GTiff();
  gdal().GDALRegister_COG();  // only for writing: importers name their driver
  gdal().RegisterOGRGeoJSON();
  gdal().RegisterOGRGeoPackage();
  gdal().RegisterOGRDXF();
  gdal().CPLSetConfigOption("DXF_INLINE_BLOCKS", "NO");  // blocks of blocks would grow without limit
  // Threads of GDAL's own have no session on their stack; their errors are reported as a failed call.
  gdal().CPLSetErrorHandler(gdal().CPLQuietErrorHandler);
}

}  // namespace

GdalSession::GdalSession() {
  static std::once_flag once;
  std::call_once(once, setUp);
  gdal().CPLErrorReset();
  gdal().CPLPushErrorHandlerEx(&GdalSession::hear, this);
}

GdalSession::~GdalSession() {
  gdal().CPLPopErrorHandler();
  gdal().CPLErrorReset();
}

void GdalSession::hear(CPLErr severity, CPLErrorNum, const char* message) {
  const int system = errno;  // GDAL reports directly after the call that failed
  auto* session = static_cast<GdalSession*>(gdal().CPLGetErrorHandlerUserData());
  if (session == nullptr || message == nullptr || severity < CE_Failure) return;
  if (!session->failed_) session->first_ = message;
  if (session->disk_error_ == 0 && isDiskError(system)) session->disk_error_ = system;
  session->failed_ = true;
}

std::string GdalSession::reason(const std::string& otherwise) const {
  std::string text = first_.empty() ? otherwise : first_;
  // "path: Function:what" and "path, band 1: what" repeat the path, which the caller's message contains
  // already.
  for (std::size_t colon; (colon = text.find(':')) != std::string::npos && colon + 1 < text.size();) {
    const std::string before = text.substr(0, colon);
    const bool path = before.find('/') != std::string::npos || before.find(".fettle-") != std::string::npos;
    const bool function = before.find(' ') == std::string::npos;
    if (!path && !function) break;
    text = text.substr(text.find_first_not_of(' ', colon + 1) == std::string::npos
                           ? colon + 1
                           : text.find_first_not_of(' ', colon + 1));
  }
  while (!text.empty() && (text.back() == '.' || text.back() == ' ' || text.back() == '\n')) text.pop_back();
  return text.empty() ? otherwise : text;
}

MemoryFile::MemoryFile(const std::string& extension, std::string content) : content_(std::move(content)) {
  static std::atomic<unsigned> count{0};
  path_ = fmt::format("/vsimem/fettle-{}{}", count++, extension);
  if (!content_.empty())
    gdal().VSIFCloseL(gdal().VSIFileFromMemBuffer(path_.c_str(), reinterpret_cast<GByte*>(content_.data()),
                                                  content_.size(), FALSE));
}

MemoryFile::~MemoryFile() {
  gdal().VSIUnlink(path_.c_str());
}

std::string_view MemoryFile::bytes() const {
  vsi_l_offset size = 0;
  const GByte* data = gdal().VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
  return {reinterpret_cast<const char*>(data), data == nullptr ? 0 : static_cast<std::size_t>(size)};
}

}  // namespace fettle::engine
