#include "pliant/analysis/hdf5_image.h"
#include "pliant/analysis/sweep_results.h"
#include "pliant/analysis/write_file.h"

namespace pliant {

using namespace internal;

namespace {

void WriteColumn(hid_t file, const std::string& name, const std::vector<double>& numbers,
                 const std::string& unit) {
  WriteNumbers(file, name.c_str(), numbers.data(), numbers.size(), 0, unit);
}

void WriteColumn(hid_t file, const std::string& name, const std::vector<std::string>& words) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  Checked(H5Tset_size(type, H5T_VARIABLE));
  Checked(H5Tset_cset(type, H5T_CSET_UTF8));
  const hsize_t count = words.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  Checked(H5Pset_obj_track_times(how, false));
  const Handle data(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT),
                    H5Dclose);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  if (!words.empty()) Checked(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()));
}

}  // namespace

void WriteSweepTables(const SweepResults& results, const std::filesystem::path& directory) {
  MakeDirectory(directory);
  const std::filesystem::path hdf5 = directory / "results.h5";
  try {
    const std::string image = Hdf5Image([&](hid_t file) {
      for (const SweepColumn& column : results.columns())
        if (const auto* numbers = std::get_if<std::vector<double>>(&column.cells))
          WriteColumn(file, column.name, *numbers, column.unit);
        else
          WriteColumn(file, column.name, std::get<std::vector<std::string>>(column.cells));
      // Of any length, which an attribute is not.
      WriteColumn(file, "sweep", std::vector<std::string>{results.sweep.text()});
    });
    WriteFile(hdf5, image);
  } catch (const Error& error) {
    const std::string what = error.what();
    throw what.find(hdf5.string()) == std::string::npos
        ? Error("cannot write " + hdf5.string() + ": " + what)
        : error;
  }
  WriteFile(directory / "results.csv", CsvOf(results));
}

}  // namespace pliant
