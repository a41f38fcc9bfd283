// vector_map's operators are declared behind the template that needs them. A newer compiler looks for them beside the
// messages, so this finds them there.
#include <istream>
#include <memory>

#include <vector_map/vector_map.h>

namespace vector_map_msgs {
template <template <class> class Message>
std::istream& operator>>(std::istream& stream, Message<std::allocator<void>>& message) {
  return ::operator>>(stream, message);
}
}  // namespace vector_map_msgs
