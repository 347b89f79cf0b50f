"""Features of a GeoJSON document (RFC 7946), and the simple geometries that a geometry consists of."""

from collections.abc import Iterator, Mapping
from typing import Any


def features_of(document: Any) -> list[Mapping[str, Any]] | None:
    """List the features of a parsed document.

    Returns
    -------
    list of mapping or None
        Those of a FeatureCollection, or a single Feature; a geometry by itself is a feature without properties. None
        for a document that is none of these.
    """
    if not isinstance(document, dict):
        return None
    if document.get("type") == "Feature":
        return [document] if "geometry" in document else None
    if document.get("type") == "GeometryCollection" or "coordinates" in document:
        return [{"type": "Feature", "geometry": document, "properties": {}}]
    found = document.get("features")
    if not isinstance(found, list) or not all(isinstance(feature, dict) for feature in found):
        return None
    return found


def properties_of(feature: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the properties of a feature, empty where it has none."""
    properties = feature.get("properties")
    return properties if isinstance(properties, dict) else {}


def simple_geometries(geometry: Any) -> Iterator[tuple[str, Any]]:
    """Yield type and coordinates of each Point, LineString and Polygon of a geometry; coordinates are not checked."""
    if not isinstance(geometry, dict):
        return
    kind, content = geometry.get("type"), geometry.get("coordinates")
    if kind in ("Point", "LineString", "Polygon"):
        yield kind, content
    elif kind in ("MultiPoint", "MultiLineString", "MultiPolygon"):
        yield from ((kind.removeprefix("Multi"), part) for part in (content if isinstance(content, list) else []))
    elif kind == "GeometryCollection" and isinstance(geometry.get("geometries"), list):
        for part in geometry["geometries"]:
            yield from simple_geometries(part)
