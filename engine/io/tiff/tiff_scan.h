#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/files/input_file.h"
#include "engine/io/height_rule.h"
#include "engine/io/import.h"
#include "engine/io/tiff/tiff_directory.h"

namespace fettle::engine {

/// A TIFF whose header was read: everything known before its samples.
struct TiffScan {
  TiffDirectory directory;
  DatasetPtr dataset;
  GDALRasterBandH band = nullptr;  ///< the one with the heights
  GDALRasterBandH mask = nullptr;  ///< of a separate mask, else null
  GDALDataType type = GDT_Unknown;
  bool signed_byte = false;    ///< GDAL 3.6 has no type of its own for these
  Grid grid;                   ///< as described at importField
  bool top_down = true;        ///< the file's first row is the highest
  bool right_to_left = false;  ///< the file's first column is the highest
  HeightRule rule;
  std::vector<std::string> warnings;
};

/// How much of a file's samples will be held.
enum class TiffExtent : std::uint8_t {
  kWhole,
  kPart,  ///< rows of a field that may be larger than memory and disk
};

/// Opens a TIFF and refuses what is not a height field, before memory is allocated for it. Errors: as
/// importField. `gdal` must exist as long as the scan is used.
[[nodiscard]] Result<TiffScan> openTiffScan(const InputFile& file, const ImportOptions& options,
                                            GdalSession& session, TiffExtent extent = TiffExtent::kWhole);

/// Calls `use` with a zero of the type of the scan's samples; false for types that are not heights.
bool withSampleType(const TiffScan& scan, auto&& use) {
  switch (scan.type) {
    case GDT_Byte:
      scan.signed_byte ? use(std::int8_t{}) : use(std::uint8_t{});
      return true;
    case GDT_UInt16:
      use(std::uint16_t{});
      return true;
    case GDT_Int16:
      use(std::int16_t{});
      return true;
    case GDT_UInt32:
      use(std::uint32_t{});
      return true;
    case GDT_Int32:
      use(std::int32_t{});
      return true;
    case GDT_UInt64:
      use(std::uint64_t{});
      return true;
    case GDT_Int64:
      use(std::int64_t{});
      return true;
    case GDT_Float32:
      use(float{});
      return true;
    case GDT_Float64:
      use(double{});
      return true;
    default:
      return false;
  }
}

}  // namespace fettle::engine
