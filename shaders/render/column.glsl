// The area that is shown as columns: filled for each picture (twin: ColumnArea in frame.h).
layout(std140, binding = kColumnAreaBinding) uniform ColumnAreaBlock { ColumnArea columns; };
