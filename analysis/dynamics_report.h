#pragma once

#include <filesystem>
#include <string>

#include "pliant/analysis/dynamics_identification.h"
#include "pliant/analysis/report.h"

namespace pliant {

/// An identification in some forty lines for a terminal: residuals of each joint, what is told
/// and what is not, the combinations with their 95 % intervals, the links.
std::string TextOf(const DynamicsResult& result);

/// The same as a page, with the residuals as bars.
Report ReportOf(const DynamicsResult& result);

/// A payload as a scenario has it: link, mass, centre, and the radius of the ball that has the mean
/// of its moments of inertia; its `<inertial>` for a URDF stands in a remark. Throws Error if the
/// result is not about a payload.
std::string PayloadYaml(const DynamicsResult& result);

/// Writes PayloadYaml to a .yaml, or to a .urdf the text of `urdf` with the inertials of the links
/// that were found. A payload's is summed with that of its link.
void WriteIdentified(const DynamicsResult& result, const std::filesystem::path& urdf,
                     const std::filesystem::path& file);

/// Before a long run: throws Error if that would fail, or if the file is there and is not to be
/// written over.
void RequireIdentifiedFile(const std::filesystem::path& file, bool payload, bool force);

}  // namespace pliant
