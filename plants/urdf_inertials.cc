#include "pliant/plants/urdf_inertials.h"

#include <tinyxml.h>

#include <sstream>

#include "pliant/plants/urdf.h"
#include "pliant/systems/error.h"

namespace pliant {

std::string InertialElement(const Inertial& inertial, const std::string& indent) {
  const auto& [m, c, I] = inertial;
  std::ostringstream out;
  out.precision(9);
  out << indent << "<inertial>\n"
      << indent << "  <origin xyz=\"" << c.x() << ' ' << c.y() << ' ' << c.z() << "\"/>\n"
      << indent << "  <mass value=\"" << m << "\"/>\n"
      << indent << "  <inertia ixx=\"" << I(0, 0) << "\" ixy=\"" << I(0, 1) << "\" ixz=\""
      << I(0, 2) << "\" iyy=\"" << I(1, 1) << "\" iyz=\"" << I(1, 2) << "\" izz=\"" << I(2, 2)
      << "\"/>\n"
      << indent << "</inertial>";
  return out.str();
}

std::string WithInertials(const std::string& urdf, const std::map<std::string, Inertial>& inertials,
                          const std::string& source) {
  internal::CheckUrdf(urdf, source);
  TiXmlDocument document;
  document.Parse(internal::Padded(urdf).c_str(), nullptr, TIXML_ENCODING_UTF8);
  for (const auto& [name, inertial] : inertials) {
    TiXmlElement* link = document.RootElement()->FirstChildElement("link");
    while (link && name != link->Attribute("name")) link = link->NextSiblingElement("link");
    Require(link != nullptr, source + ": there is no link \"" + name + '"');
    TiXmlDocument element;
    element.Parse(InertialElement(inertial).c_str());
    if (TiXmlElement* old = link->FirstChildElement("inertial"))
      link->ReplaceChild(old, *element.RootElement());
    else
      link->InsertEndChild(*element.RootElement());
  }
  TiXmlPrinter printer;
  printer.SetIndent("  ");
  document.Accept(&printer);
  return printer.CStr();
}

}  // namespace pliant
