#include "pliant/analysis/hdf5_image.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

constexpr hsize_t kChunkRows = 1000;
constexpr std::size_t kGrowth = 1 << 20;  // of the file in memory
constexpr unsigned kDeflate = 1;  // noise of sensors is packed hardly better at higher levels

/// While it lives, HDF5 prints nothing of its own.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// What went wrong at the bottom of the library.
std::string Reason() {
  std::string reason;
  const auto first = [](unsigned, const H5E_error2_t* error, void* text) -> herr_t {
    auto& out = *static_cast<std::string*>(text);
    if (out.empty() && error->desc) out = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first, &reason);
  return reason.empty() ? "HDF5 does not say why" : reason;
}

}  // namespace

hid_t Checked(hid_t id) {
  if (id < 0) throw Error(Reason());
  return id;
}

void WriteWords(hid_t where, const std::string& name, const std::vector<std::string>& words,
                bool scalar) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  Checked(H5Tset_size(type, H5T_VARIABLE));
  Checked(H5Tset_cset(type, H5T_CSET_UTF8));
  const hsize_t count = words.size();
  const Handle space(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr),
                     H5Sclose);
  const Handle names(H5Pcreate(H5P_ATTRIBUTE_CREATE), H5Pclose);
  Checked(H5Pset_char_encoding(names, H5T_CSET_UTF8));
  const Handle attribute(H5Acreate2(where, name.c_str(), type, space, names, H5P_DEFAULT),
                         H5Aclose);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  // Of no words the library wants none.
  if (!words.empty()) Checked(H5Awrite(attribute, type, pointers.data()));
}

void WriteWord(hid_t where, const std::string& name, const std::string& word) {
  WriteWords(where, name, {word}, true);
}

void WriteNumbers(hid_t where, const char* name, const double* numbers, hsize_t rows,
                  hsize_t columns, std::string_view unit) {
  const std::array<hsize_t, 2> size{rows, columns};
  const std::array<hsize_t, 2> chunk{std::clamp<hsize_t>(rows, 1, kChunkRows),
                                     std::max<hsize_t>(columns, 1)};
  const int rank = columns == 0 ? 1 : 2;
  const Handle space(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  Checked(H5Pset_chunk(how, rank, chunk.data()));
  Checked(H5Pset_shuffle(how));
  Checked(H5Pset_deflate(how, kDeflate));
  Checked(H5Pset_obj_track_times(how, false));  // the same recording gives the same bytes
  const Handle data(H5Dcreate2(where, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, how, H5P_DEFAULT),
                    H5Dclose);
  if (rows > 0) Checked(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers));
  if (!unit.empty()) WriteWord(data, "unit", std::string(unit));
}

Handle MakeGroup(hid_t file, const std::string& name) {
  const Handle above(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  Checked(H5Pset_create_intermediate_group(above, 1));
  Checked(H5Pset_char_encoding(above, H5T_CSET_UTF8));
  const Handle how(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  Checked(H5Pset_obj_track_times(how, false));
  // Another signal's path may go through it.
  const bool is_there = [&] {
    for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
      if (H5Lexists(file, name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
      if (end == std::string::npos) return true;
    }
  }();
  return {is_there ? H5Gopen2(file, name.c_str(), H5P_DEFAULT)
                   : H5Gcreate2(file, name.c_str(), above, how, H5P_DEFAULT),
          H5Gclose};
}

std::string Hdf5Image(const std::function<void(hid_t file)>& write) {
  const Quiet quiet;
  const Handle in_memory(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Checked(H5Pset_fapl_core(in_memory, kGrowth, /*backing_store=*/false));
  const Handle how(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  Checked(H5Pset_obj_track_times(how, false));
  const Handle file(H5Fcreate("recording", H5F_ACC_TRUNC, how, in_memory), H5Fclose);
  write(static_cast<hid_t>(file));
  Checked(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw Error(Reason());
  std::string image(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, image.data(), image.size()) < 0) throw Error(Reason());
  return image;
}

}  // namespace pliant::internal
