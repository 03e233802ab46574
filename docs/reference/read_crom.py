#!/usr/bin/env python3
"""Reads a .crom file, written from docs/reference/model-file.md alone: python3 read_crom.py FILE [T]

Prints, as one JSON object, the dimensions of the model and, at one sample of each cluster, the positions of some nodes
at the instant T (default 1). It needs nothing but Python.
"""
import json
import math
import struct
import sys
import zlib


class Reader:
    """The payload, read from front to back."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        if self.at > len(self.data):
            raise ValueError("the payload ends early")
        return self.data[self.at - count : self.at]

    def u8(self):
        return self.take(1)[0]

    def integer(self):
        value, shift = 0, 0
        while True:
            byte = self.u8()
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    def f64(self):
        return struct.unpack("<d", self.take(8))[0]

    def bytes(self):
        return self.take(self.integer())

    def text(self):
        return self.bytes().decode()

    def blob(self):
        self.bytes()  # the pad
        return self.bytes()

    def u16s(self):
        data = self.blob()
        return struct.unpack(f"<{len(data) // 2}H", data)

    def list(self, item):
        return [item() for _ in range(self.integer())]

    def option(self, item):
        return item() if self.u8() else None

    def matrix(self):
        rows, columns, encoding = self.integer(), self.integer(), self.integer()
        wide = self.integer() if encoding else 0
        return Matrix(rows, columns, encoding, wide, self.blob())


class Matrix:
    """A stored matrix: `matrix[row, column]` decodes an entry."""

    def __init__(self, rows, columns, encoding, wide, data):
        self.rows, self.columns, self.encoding, self.wide = rows, columns, encoding, wide
        count = [0, columns, columns, rows][encoding]
        self.scales, self.data = struct.unpack(f"<{count}f", data[: 4 * count]), data[4 * count :]

    def byte(self, column, row, blocks):
        """The signed byte in a column and row of the table, whose panels have so many blocks."""
        start = 16 * (row // 8 * blocks + column // 2) + 4 * (row % 8 // 2) + 2 * (column % 2) + row % 2
        return struct.unpack_from("<b", self.data, start)[0]

    def __getitem__(self, index):
        row, column = index
        wide = column < self.wide
        if self.encoding == 0:
            return struct.unpack_from("<f", self.data, 4 * (row * self.columns + column))[0]
        if self.encoding == 1:
            blocks = (self.rows + 1) // 2
            low = self.byte(row, column, blocks)
            value = 256 * self.byte(row, self.columns + column, blocks) + low if wide else low
            return value * self.scales[column]
        blocks = self.wide + (self.columns - self.wide + 1) // 2
        if wide:
            value = 256 * self.byte(2 * column, row, blocks) + self.byte(2 * column + 1, row, blocks)
        else:
            value = self.byte(self.wide + column, row, blocks)
        return value * self.scales[column if self.encoding == 2 else row]


def errors(r):
    return {"matrices": [r.matrix() for _ in range(4)], "floor": r.f64()}


def span(r):
    return {"parameter_modes": r.matrix(), "slices": r.u16s(), "core": r.matrix()}


def cluster(r):
    return {
        "min": r.f64(), "max": r.f64(), "parameters": r.matrix(), "coordinates": r.matrix(), "modes": r.matrix(),
        "knots": r.matrix(), "spans": r.list(lambda: span(r)), "axial_controls": r.matrix(), "axial_modes": r.matrix(),
        "errors": [errors(r), errors(r)], "interval_errors": r.matrix(), "interval_bound_factors": r.matrix(),
    }


def contents(r):
    """The whole payload."""
    c = {"title": r.text(), "units": [r.text() for _ in range(3)], "law": r.text(), "bending": r.option(r.f64)}
    c["parameters"] = r.list(lambda: [r.text()] + [r.f64() for _ in range(4)])
    c["database_digest"], c["settings"], c["created"] = r.text(), r.text(), r.integer()
    c["nodes"], c["element_nodes"], c["elements"], c["reference"] = r.integer(), r.u8(), r.u16s(), r.integer()
    c["shape"] = [r.f64() for _ in range(4)] if c["reference"] == 1 else None
    c["sector"], c["operations"], c["images"], c["origins"] = r.matrix(), r.blob(), r.u16s(), r.u16s()
    c["node_sets"] = dict(r.list(lambda: (r.text(), r.u16s())))
    c["times"], c["error_times"], c["steady_limit"] = r.matrix(), r.matrix(), r.matrix()
    c["bending_effect"], c["border"], c["default_method"] = r.matrix(), r.matrix(), r.integer()
    c["kernel"] = [r.integer()] + [r.f64() for _ in range(4)]
    c["paper"] = [r.integer()] + [r.f64() for _ in range(5)] + [r.integer(), r.integer(), r.f64()]
    c["split"], c["clusters"] = r.u8(), r.list(lambda: cluster(r))
    return c


def open_model(path):
    with open(path, "rb") as file:
        data = file.read()
    magic, version, length, checksum = struct.unpack_from("<4sIII", data)
    payload = data[16:]
    if (magic, version, length) != (b"CROM", 10, len(payload)) or zlib.crc32(payload) != checksum:
        raise ValueError(f"{path} is no whole model file of format 10")
    reader = Reader(payload)
    model = contents(reader)
    if reader.at != length:
        raise ValueError("bytes follow the message")
    return model, checksum


def splines(knots, t):
    """The cubic B-splines that differ from 0 at t, by the recursion of Cox and de Boor: {control: value}."""
    count = len(knots) - 4
    last = max(i for i in range(3, count) if knots[i] <= t)
    values = {last: 1.0}
    for degree in range(1, 4):
        values = {
            i: sum(
                share * values.get(j, 0.0)
                for share, j in [
                    ((t - knots[i]) / ((knots[i + degree] - knots[i]) or 1.0), i),
                    ((knots[i + degree + 1] - t) / ((knots[i + degree + 1] - knots[i + 1]) or 1.0), i + 1),
                ]
            )
            for i in range(last - degree, last + 1)
        }
    return values


def coefficients(part, sample, t):
    """Axial coefficient and shape coefficients of a sample at t."""
    axial, shape = 0.0, [0.0] * part["modes"].columns
    knots = [part["knots"][i, 0] for i in range(part["knots"].rows)]
    for control, weight in splines(knots, t).items():
        columns = range(part["axial_modes"].columns)
        axial += weight * sum(part["axial_controls"][control, k] * part["axial_modes"][sample, k] for k in columns)
        for span in part["spans"]:
            if control < len(span["slices"]):
                break
            control -= len(span["slices"])
        first, count = 8 * sum(span["slices"][:control]), 8 * span["slices"][control]
        psi = [span["parameter_modes"][sample, k] for k in range(span["core"].columns)]
        for row in range(min(count, len(shape))):
            shape[row] += weight * sum(span["core"][first + row, k] * p for k, p in enumerate(psi))
    return axial, shape


def position(model, part, node, axial, shape, factor):
    """Position of a node in the laboratory frame."""
    size = model["sector"].rows
    place = model["origins"][node]
    operation, sector = model["operations"][place // size], place % size
    rows = 8 * ((size + 7) // 8)
    x, y, z = (
        factor * model["sector"][sector, d] + sum(part["modes"][d * rows + sector, k] * c for k, c in enumerate(shape))
        for d in range(3)
    )
    y, z = (z, y) if operation & 4 else (y, z)
    y, z = (-y if operation & 1 else y), (-z if operation & 2 else z)
    return [x + axial / math.sqrt(model["nodes"]), y, z]


def answer(model, part, sample, t):
    """Parameters of a sample, and positions of some nodes at t."""
    scaled = [part["parameters"][sample, p] for p in range(len(model["parameters"]))]
    parameters = [origin + scale * s for s, (_, _, _, origin, scale) in zip(scaled, model["parameters"])]
    axial, shape = coefficients(part, sample, t)
    factor, offset = (parameters[1], 0.0) if model["reference"] == 0 else (1.0, model["shape"][1])
    nodes = range(0, model["nodes"], max(1, model["nodes"] // 16))
    places = [position(model, part, node, axial, shape, factor) for node in nodes]
    positions = {node: [x + offset, y, z] for node, (x, y, z) in zip(nodes, places)}
    return {"parameters": parameters, "t": t, "positions": positions}


def main(path, t=1.0):
    model, digest = open_model(path)
    clusters = model["clusters"]
    print(json.dumps({
        "digest": digest,
        "title": model["title"],
        "nodes": model["nodes"],
        "elements": len(model["elements"]) // model["element_nodes"],
        "instants": model["times"].rows,
        "end_time": model["times"][model["times"].rows - 1, 0],
        "node_sets": {name: len(nodes) for name, nodes in model["node_sets"].items()},
        "clusters": [{"samples": c["parameters"].rows, "modes": c["modes"].columns} for c in clusters],
        "answers": [answer(model, c, c["parameters"].rows // 2, float(t)) for c in clusters],
    }, indent=1))


if __name__ == "__main__":
    main(*sys.argv[1:])
