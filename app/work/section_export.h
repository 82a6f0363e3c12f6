#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/work/kept_sections.h"
#include "app/work/section_files.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::app {

/// Sections that are to be written to a file.
struct SectionsToWrite {
  std::vector<KeptSection> sections;
  engine::Version field;
  engine::Version before;  ///< of the same size, whose profiles stand beside those of the field; empty: none
};

/// Takes them as `fettle section --kept` does, with `before` as its --compare, and writes them as its --csv, --plot and --dxf do, by the
/// ending of `path`: .csv, .svg, .png, .dxf; the whole file or none. Where `before` has no height along a line, its places there are
/// empty.
///
/// Errors: as engine::sectionAlong, naming the section, from 1; an ending of no such file (kInput); as drawSections. kCancelled.
/// Thread: any.
[[nodiscard]] engine::Status writeSections(const SectionsToWrite& what, const std::string& path,
                                           engine::JobControl& job);

}  // namespace fettle::app
