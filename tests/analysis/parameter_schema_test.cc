#include "pliant/analysis/parameter_schema.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

using internal::Json;

TEST(ParameterSchema, TakesANumberAListOrRowsForAMatrixOfAnySize) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  const Json schema = internal::SchemaOf<Matrix>("", kAnyNumber);
  const Json number = internal::SchemaOf<double>("", kAnyNumber);
  ASSERT_EQ(schema["anyOf"].size(), 4U);
  EXPECT_EQ(schema["anyOf"][0], number);
  EXPECT_EQ(schema["anyOf"][1], (Json{{"type", "array"}, {"items", number}}));
  EXPECT_EQ(schema["anyOf"][2]["items"], schema["anyOf"][1]);
  EXPECT_EQ(schema["anyOf"][3], (Json{{"type", "null"}}));
}

TEST(ParameterSchema, KeepsTheSizeOfAMatrixThatHasOne) {
  const Json schema = internal::SchemaOf<Eigen::Matrix2d>("", kAnyNumber);
  EXPECT_EQ(schema["type"], "array");
  EXPECT_EQ(schema["minItems"], 2);
  EXPECT_EQ(schema["items"]["type"], "array");
  EXPECT_EQ(internal::SchemaOf<Eigen::Vector3d>("", kAnyNumber)["maxItems"], 3);
}

}  // namespace
}  // namespace pliant
