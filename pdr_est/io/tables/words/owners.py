"""Titles of columns that tell whose row it is: of a device, a person, a session or an activity."""

from collections.abc import Mapping
from enum import StrEnum


class Owner(StrEnum):
    """Kind of owner that the values of a column name."""

    DEVICE = "device"
    PERSON = "person"
    SESSION = "session"
    ACTIVITY = "activity"
    ANY = "owner"
    """It is not known: only the times of the rows tell whether they are of one signal."""


def _names(text: str, owner: Owner) -> dict[str, Owner]:
    return dict.fromkeys(text.split(), owner)


OWNERS: Mapping[str, Owner] = {
    **_names(
        """device deviceid devicename devicetag dev phone phoneid phonename smartphone handset sensorlocation
        sensorposition sensorplacement bodypart bodylocation bodyposition placement position location node nodeid imu
        imuid board boardid mac macaddress address serial serialnumber watch gerat gerate geratename telefon
        appareil dispositivo 设备 手机 端末 デバイス""",
        Owner.DEVICE,
    ),
    **_names(
        """user userid username subject subjectid subj subjid person personid participant participantid volunteer
        volunteerid pid walker nutzer nutzername benutzer proband probanden teilnehmer usuario sujeto utilisateur
        sujet 用户 被験者 ユーザー""",
        Owner.PERSON,
    ),
    **_names(
        """session sessionid trial trialid trialnumber trialno run runid runnumber walk walkid recording recordingid
        experiment experimentid exp expid sequence sequenceid series seriesid file filename fileid repetition rep
        track trackid trip tripid route routeid group groupid measurementid versuch messung durchgang lauf aufnahme
        sitzung essai""",
        Owner.SESSION,
    ),
    **_names(
        """activity activityid activityname activitylabel label labels class classid task taskid state mode gt
        aktivitat actividad activite 活动 活動""",
        Owner.ACTIVITY,
    ),
    **_names("id uid name tag source number", Owner.ANY),
}
"""Title without separators, case and accents -> what its values stand for."""

OWNERS_IN_WORDS = frozenset(
    {"position", "location", "address", "state", "mode", "track", "file", "name", "source", "tag", "watch", "imu"}
)
"""Titles whose numbers mean something else, such as a coordinate."""
