#include <charconv>

#include "pliant/analysis/hdf5_image.h"
#include "pliant/analysis/sweep_results.h"
#include "pliant/analysis/write_file.h"

namespace pliant {

using namespace internal;

namespace {

void WriteColumn(hid_t file, const std::string& name, const std::vector<double>& numbers,
                 const std::string& unit = "") {
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

/// All of them as numbers; empty if one is none.
std::vector<double> NumbersOf(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words) {
    const char* const end = word.data() + word.size();
    if (std::from_chars(word.data(), end, numbers.emplace_back()).ptr != end) return {};
  }
  return numbers;
}

/// A dataset for each column, by its name.
void Write(const SweepResults& results, hid_t file) {
  const Sweep& sweep = results.sweep;
  const auto column = [&](const std::string& name, const auto& of, const std::string& unit = "") {
    std::vector<double> numbers;
    for (const SweepRow& row : results.rows) numbers.push_back(static_cast<double>(of(row)));
    WriteColumn(file, name, numbers, unit);
  };
  const auto words = [&](const std::string& name, const auto& of) {
    std::vector<std::string> all;
    for (const SweepRow& row : results.rows) all.push_back(of(row));
    WriteColumn(file, name, all);
  };
  column("run", [](const SweepRow& row) { return row.run; });
  bool sweeps_seed = false;
  for (std::size_t i = 0, random = 0; i < sweep.over().size(); ++i) {
    const Swept& swept = sweep.over()[i];
    sweeps_seed = sweeps_seed || swept.path() == "seed";
    const std::vector<double> numbers = NumbersOf(swept.values());
    if (swept.is_random()) {
      column(swept.path(), [&](const SweepRow& row) { return row.drawn[random]; });
      ++random;
    } else if (!numbers.empty()) {
      column(swept.path(),
             [&](const SweepRow& row) { return numbers[sweep.IndicesOf(row.run)[i]]; });
    } else {
      words(swept.path(),
            [&](const SweepRow& row) { return swept.values()[sweep.IndicesOf(row.run)[i]]; });
    }
  }
  if (!sweeps_seed) column("seed", [&](const SweepRow& row) { return sweep.SeedOf(row.run); });
  for (std::size_t i = 0; i < sweep.numbers().size(); ++i)
    column(
        sweep.numbers()[i].name, [&](const SweepRow& row) { return row.numbers[i]; },
        sweep.units()[i]);
  words("ended", [](const SweepRow& row) { return row.ended; });
  words("failed", [](const SweepRow& row) { return row.failed; });
}

/// Of any length, which an attribute is not.
void WriteText(hid_t file, const std::string& text) { WriteColumn(file, "sweep", {text}); }

}  // namespace

void WriteSweepTables(const SweepResults& results, const std::filesystem::path& directory) {
  MakeDirectory(directory);
  const std::filesystem::path hdf5 = directory / "results.h5";
  try {
    const std::string image = Hdf5Image([&](hid_t file) {
      Write(results, file);
      WriteText(file, results.sweep.text());
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
