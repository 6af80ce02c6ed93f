#include "pliant/analysis/page_run.h"

#include <Eigen/Geometry>

#include "pliant/analysis/write_file.h"
#include "pliant/plants/shared_file.h"

namespace pliant::internal {

namespace {

Json Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void AddPlace(Json& json, const Pose& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  json["position"] = Numbers(pose.position);
  json["rotation"] = {q.w(), q.x(), q.y(), q.z()};
}

Json JsonOf(const Shape& shape, const Pose& X_BL) {
  Json json;
  const auto round = [&](const char* name) {
    json = {{"shape", name}, {"radius", shape.size.x()}, {"length", shape.size.y()}};
  };
  switch (shape.kind) {
    case Shape::Kind::Box:
      json = {{"shape", "box"}, {"size", Numbers(shape.size)}};
      break;
    case Shape::Kind::Sphere:
      json = {{"shape", "sphere"}, {"radius", shape.size.x()}};
      break;
    case Shape::Kind::Cylinder:
      round("cylinder");
      break;
    case Shape::Kind::Capsule:
      round("capsule");
  }
  AddPlace(json, X_BL * shape.pose);
  json["color"] = Numbers(shape.color.head<3>());
  return json;
}

/// Bodies are what moves; the links are frames on them.
std::string BodyName(int body) { return body < 0 ? "world" : "body " + std::to_string(body); }

}  // namespace

Json PageRobot(const RobotModel& model, const std::string& tool) {
  Json links = Json::array({{{"name", "world"}, {"visuals", Json::array()}}});
  Json joints = Json::array();
  const auto bodies = model.bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    const Joint& joint = model.joint(body.joint);
    links.push_back({{"name", BodyName(static_cast<int>(b))}, {"visuals", Json::array()}});
    Json json{{"name", joint.name},
              {"parent", BodyName(body.parent)},
              {"child", BodyName(static_cast<int>(b))},
              {"type", body.revolute ? "revolute" : "prismatic"},
              {"axis", {0, 0, 1}}};
    AddPlace(json, body.pose);
    joints.push_back(std::move(json));
  }
  const auto add_frame = [&](const Link& link) {
    Json visuals = Json::array();
    for (const Shape& shape : link.visuals) visuals.push_back(JsonOf(shape, Pose{}));
    links.push_back({{"name", link.name}, {"visuals", std::move(visuals)}});
    Json json{{"name", "to " + link.name},
              {"parent", BodyName(link.body)},
              {"child", link.name},
              {"type", "fixed"},
              {"axis", {0, 0, 1}}};
    AddPlace(json, link.pose);
    joints.push_back(std::move(json));
  };
  Json frames = Json::array();
  for (const Link& link : model.links()) frames.push_back(link.name);
  // The path that is shown is that of the last.
  for (const Link& link : model.links())
    if (link.name != tool) add_frame(link);
  add_frame(model.link(model.link_index(tool)));
  return {{"links", links}, {"joints", joints}, {"frames", frames}};
}

Json PageRun(const std::string& title, const std::vector<const RecordedValue*>& values,
             const RobotModel& model, const std::vector<Push::Options>& pushes) {
  Json columns = Json::array({{{"name", "time"}, {"unit", "s"}}});
  Json joints = Json::array(), forces = Json::array(), bands = Json::array();
  for (const RecordedValue* value : values) {
    for (std::size_t i = 0; i < value->elements.size(); ++i) {
      std::string element = value->elements[i];
      if (element.starts_with('[') && element.ends_with(']'))
        element = element.substr(1, element.size() - 2);
      columns.push_back({{"name", value->path + value->elements[i]},
                         {"path", value->path},
                         {"element", element},
                         {"unit", value->units[i]}});
    }
    if (value->type != ContactForce::quantity.name) continue;
    const auto vector = [&](const char* field) {
      Json names = Json::array();
      for (const char* axis : {"[x]", "[y]", "[z]"}) names.push_back(value->path + field + axis);
      return names;
    };
    forces.push_back({{"name", value->path},
                      {"link", value->path + ".link"},
                      {"point", vector(".point")},
                      {"force", vector(".force")}});
  }
  for (const Body& body : model.bodies())
    joints.push_back("arm.measured_position[" + model.joint(body.joint).name + "]");
  for (std::size_t i = 0; i < pushes.size(); ++i)
    bands.push_back({{"from", pushes[i].start_s},
                     {"to", pushes[i].start_s + pushes[i].duration_s},
                     {"label", "push " + std::to_string(i + 1)}});
  return {{"title", title},
          {"columns", columns},
          {"joints", joints},
          {"forces", forces},
          {"bands", bands}};
}

std::string PageEnd(const Json& runs, const std::vector<std::string>& data, const char* script) {
  std::string end;
  for (std::size_t i = 0; i < data.size(); ++i)
    end += "<script type=\"text/plain\" id=\"data-" + std::to_string(i) + "\">" + data[i] +
           "</script>\n";
  std::string json = runs.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
    json.replace(at, 1, "\\u003c");
  const std::string dist = "web/dist/" + std::string(script);
  return end + "<script type=\"application/json\" id=\"runs\">" + json + "</script>\n<style>" +
         ReadFile(SharedFile(dist + ".css")) + "</style>\n<script>" +
         ReadFile(SharedFile(dist + ".js")) + "</script>\n";
}

}  // namespace pliant::internal
