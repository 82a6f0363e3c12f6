// OpenEXR: channel Y, float32, ZIP. Holes are NaN.

#include <algorithm>
#include <exception>
#include <string_view>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/format.h"
#include "engine/io/grid_notes.h"

namespace fettle::engine {

namespace {

Status writePicture(const Version& field, const std::string& path, JobControl& job) {
  const Grid& grid = field.grid();
  Imf::Header header(grid.width, grid.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.insert("fettle", Imf::StringAttribute(gridNotes(grid)));
  Imf::OutputFile picture(path.c_str(), header);
  const auto width = static_cast<std::size_t>(grid.width);
  std::vector<float> rows(width * kTileSide);
  const FieldReader reader = field.reader();
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  for (std::int32_t top = 0; top < grid.height; top += kTileSide) {
    const std::int32_t count = std::min(kTileSide, grid.height - top);
    // Read in reverse order: the first row of the file is the highest one of the field.
    reader.readHeights(0, grid.height - top - count, grid.width, count,
                       rows.data() + static_cast<std::ptrdiff_t>(count - 1) * grid.width, -grid.width);
    Imf::FrameBuffer frame;
    frame.insert("Y",
                 Imf::Slice(Imf::FLOAT,
                            reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(rows.data()) -
                                                    static_cast<std::size_t>(top) * width * sizeof(float)),
                            sizeof(float), width * sizeof(float)));
    picture.setFrameBuffer(frame);
    picture.writePixels(count);
    job.advance(static_cast<std::uint64_t>(count));
    if (job.cancelled()) return cancelled();
  }
  return {};
}

}  // namespace

// Channel Y, float32, holes = NaN; units, spacing, origin: an attribute of its own.
Result<Exported> writeExr(const Version& field, const std::string& path, const ExportOptions&,
                          JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  try {
    if (Status status = writePicture(field, file->temporaryPath(), job); !status)
      return tl::unexpected(status.error());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    // Its message names the temporary file.
    const bool named = std::string_view(error.what()).find(file->temporaryPath()) != std::string_view::npos;
    return tl::unexpected(
        file->explained(failure(named ? "the file cannot be written"
                                      : fmt::format("the file cannot be written: {}", error.what()),
                                path, "check the disk or choose another folder")
                            .value()));
  }
  if (Status done = file->commit(); !done) return tl::unexpected(done.error());
  return Exported{
      "EXR",
      {"OpenEXR has no units, spacing or coordinate system: they are kept in an attribute that only "
       "this program reads"}};
}

}  // namespace fettle::engine
