// What experiment_schema_test.py asks for: `schema`, or `text FILE`, the effective text of a file.

#include <iostream>
#include <string_view>

#include "pliant/analysis/experiment.h"

int main(int count, char** arguments) {
  if (count == 3 && std::string_view(arguments[1]) == "text")
    std::cout << pliant::ExperimentFile::Read(arguments[2]).text();
  else
    std::cout << pliant::ExperimentSchema();
}
