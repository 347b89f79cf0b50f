from pdr_est.types.findings import Finding, FindingKind


def test_a_finding_names_its_device_once() -> None:
    kind = FindingKind.NORTH
    assert Finding(kind, "north is disturbed").words == "north is disturbed"
    assert Finding(kind, "north is disturbed", "1L").words == "1L: north is disturbed"
    assert Finding(kind, "1L: north is disturbed", "1L").words == "1L: north is disturbed"
