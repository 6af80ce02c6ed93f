// Fields names numbers, Eigen vectors and matrices, arrays and structs of such
#include <string>

#include "pliant/systems/block.h"

struct Note {
  std::string text;
  template <class Visitor>
  void Fields(Visitor&& f) {
    f("text", text, "");
  }
};

class Writer final : public pliant::Block {
 public:
  pliant::Output<Note> y{this, "y"};
};
