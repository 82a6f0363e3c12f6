#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/section_noise.h"

namespace fettle::app {

/// The noise that the errors of a section of this field are by: of samples by engine::estimateNoise, of rows and columns by
/// engine::measureNoise. One for the command line, the window and reports. Errors: kCancelled. Thread: any; a long job.
[[nodiscard]] engine::Result<engine::SectionNoise> sectionNoiseOf(const engine::Version& field,
                                                                  engine::JobControl& job);

/// The louder of both in each: what a filter has made smooth still has the noise of before in what is averaged over more than
/// its window.
[[nodiscard]] engine::SectionNoise louderOf(const engine::SectionNoise& a,
                                            const engine::SectionNoise& b) noexcept;

}  // namespace fettle::app
