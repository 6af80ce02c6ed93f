// Writes columns as they are and as a page has them, for web/test/page_data_test.mjs:
//
//   page_data_sample FOLDER     NAME.f64 (rows, columns, then column after column) and NAME.txt

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>

#include "pliant/analysis/page_data.h"
#include "pliant/systems/random.h"

namespace {

using pliant::internal::PageColumns;

void Write(const std::filesystem::path& folder, const std::string& name, const PageColumns& columns,
           int bits) {
  std::ofstream numbers(folder / (name + ".f64"), std::ios::binary);
  const auto write = [&](double value) {
    numbers.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  write(static_cast<double>(columns[0].size()));
  write(static_cast<double>(columns.size()));
  for (const std::vector<double>& column : columns)
    for (const double value : column) write(value);
  std::ofstream(folder / (name + ".txt")) << pliant::internal::PageData(columns, bits);
}

PageColumns Mixed(std::size_t rows) {
  const pliant::RandomStream random{7};
  PageColumns columns(8);
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = 2.5 + 1e-3 * static_cast<double>(i);
    const bool gap = random.Uniform(i) < 0.1;
    columns[0].push_back(t);
    columns[1].push_back(3 * std::sin(2 * t));                    // smooth
    columns[2].push_back(40 + random.Normal(i));                  // noisy
    columns[3].push_back(std::floor(5 * random.Uniform(i)) - 2);  // whole numbers
    columns[4].push_back(-1.25);                                  // constant
    columns[5].push_back(gap ? std::nan("") : std::cos(t));       // with gaps
    columns[6].push_back(i % 2 ? 1.5e308 : -1.5e308);             // a range past double
    columns[7].push_back(i % 3 ? std::numeric_limits<double>::infinity() : 0.1 + t);
  }
  return columns;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "page_data_sample FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  for (const int bits : {16, 24}) {
    const std::string suffix = "_" + std::to_string(bits);
    Write(folder, "mixed" + suffix, Mixed(2000), bits);
    Write(folder, "one_row" + suffix, Mixed(1), bits);
    Write(folder, "no_row" + suffix, Mixed(0), bits);
    Write(folder, "uneven_time" + suffix, {{-1, 0, 0, 1e-9, 3.000000007, 9e5}}, bits);
  }
}
