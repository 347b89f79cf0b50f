"""GeoJSON documents are taken apart in one way, whoever reads them."""

from typing import Any

import pytest

from pdr_est.io.text.geojson import features_of, properties_of, simple_geometries

POINT = {"type": "Point", "coordinates": [1.0, 2.0]}
FEATURE = {"type": "Feature", "geometry": POINT, "properties": {"name": "a"}}


def test_features_of_every_kind_of_document() -> None:
    assert features_of({"type": "FeatureCollection", "features": [FEATURE, FEATURE]}) == [FEATURE, FEATURE]
    assert features_of(FEATURE) == [FEATURE]
    for geometry in (POINT, {"type": "GeometryCollection", "geometries": [POINT]}):
        (bare,) = features_of(geometry) or []
        assert (bare["geometry"], properties_of(bare)) == (geometry, {})


@pytest.mark.parametrize("document", [[], 7, None, {}, {"type": "Feature"}, {"features": [7]}, {"features": {}}])
def test_what_is_no_geojson_has_no_features(document: Any) -> None:
    assert features_of(document) is None


def test_geometries_are_taken_apart() -> None:
    ring = [[0, 0], [1, 0], [1, 1], [0, 0]]
    lines = {"type": "MultiLineString", "coordinates": [[[0, 0], [1, 1]], [[2, 2], [3, 3]]]}
    floors = {"type": "MultiPolygon", "coordinates": [[ring], [ring]]}
    whole = {"type": "GeometryCollection", "geometries": [POINT, lines, {**lines, "type": "odd"}, floors]}
    kinds = [kind for kind, _ in simple_geometries(whole)]
    assert kinds == ["Point", "LineString", "LineString", "Polygon", "Polygon"]
    assert next(simple_geometries(floors)) == ("Polygon", [ring])


@pytest.mark.parametrize("geometry", [None, 3, {}, {"type": "MultiPoint", "coordinates": 7}, {"type": "Curve"}])
def test_what_is_no_geometry_has_no_parts(geometry: Any) -> None:
    assert list(simple_geometries(geometry)) == []


def test_properties_that_are_none_are_empty() -> None:
    assert properties_of({"properties": None}) == properties_of({}) == {}
