#include "shaders/host/gl_crater_table.h"

#include <vector>

#include "shaders/host/gl_context.h"
#include "shaders/sim/crater_table.h"

namespace spoor {

GlCraterTable::GlCraterTable(std::int64_t block_bytes)
    : head_(makeBuffer()),
      shapes_("the craters", block_bytes, GrowingBuffer::Content::kept),
      first_("the buckets of craters", block_bytes),
      used_("the buckets of craters", block_bytes),
      entries_("the entries of craters", block_bytes) {
  const rules::CraterHead none{1, 0, 0, -1, 0, 1, {}};
  glNamedBufferStorage(head_.name(), sizeof(rules::CraterHead), &none, GL_DYNAMIC_STORAGE_BIT);
}

Status GlCraterTable::update(const CraterSet& craters, std::int32_t cell_q) {
  const CraterTable& table = craters.table();
  std::vector<rules::CraterShape> shapes;
  for (const Crater& crater : craters.records().subspan(count_)) shapes.push_back(shapeOf(crater));
  const auto send = [](GrowingBuffer& buffer, std::size_t offset, const auto& values) {
    const auto bytes = std::int64_t(values.size() * sizeof(values[0]));
    if (Status status = buffer.reserve(std::int64_t(offset) + bytes); !status) return status;
    if (bytes > 0) glNamedBufferSubData(buffer.name(), GLintptr(offset), bytes, values.data());
    return Status{};
  };
  if (Status status = send(shapes_, count_ * sizeof(rules::CraterShape), shapes); !status) return status;
  if (Status status = send(first_, 0, table.first); !status) return status;
  if (Status status = send(used_, 0, table.used); !status) return status;
  if (Status status = send(entries_, 0, table.entries); !status) return status;
  const rules::CraterHead head{
      table.side_q, table.width_q, table.height_q, table.mask(), int(craters.size()), cell_q, {}};
  glNamedBufferSubData(head_.name(), 0, sizeof head, &head);
  count_ = craters.size();
  return glStatus("sending craters");
}

void GlCraterTable::bind(int first_binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(first_binding), head_.name());
  int binding = first_binding;
  for (const GrowingBuffer* buffer : {&shapes_, &first_, &used_, &entries_}) buffer->bind(++binding);
}

void GlCraterTable::forget() {
  count_ = 0;
  const rules::CraterHead none{1, 0, 0, -1, 0, 1, {}};
  glNamedBufferSubData(head_.name(), 0, sizeof none, &none);
}

std::int64_t GlCraterTable::deviceBytes() const {
  return std::int64_t(sizeof(rules::CraterHead)) + shapes_.bytes() + first_.bytes() + used_.bytes() + entries_.bytes();
}

}  // namespace spoor
