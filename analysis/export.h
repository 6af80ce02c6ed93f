#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pliant/analysis/recording.h"

namespace pliant {

/// Writes a recording to an HDF5 file, which h5py, MATLAB and Julia read:
///
///   /arm/measured_velocity/time  rows            unit "s"
///                         /data  rows × elements
///                         type, elements, units  attributes of the group
///   /metadata/pliant                             its words as attributes
///
/// A value's path gives its group; the robot's description is the attribute robot_description of
/// the file. Throws Error if the file is there and is not to be written over, or cannot be written;
/// an older file then stays as it was.
void ExportHdf5(const Recording& recording, const std::filesystem::path& file, bool force = false);

/// Writes the signals of these paths, or all, to a CSV file: a row for each time under a row of
/// names, path[element] (unit), as Log::WriteCsv does. Numbers are read back exactly. Throws Error
/// as above, and if the signals have not all the same times.
void ExportCsv(const Recording& recording, const std::filesystem::path& file,
               const std::vector<std::string>& paths = {}, bool force = false);

}  // namespace pliant
