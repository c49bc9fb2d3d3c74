//! The texts in German.

use super::SmcError as E;

/// What an error means.
#[expect(clippy::too_many_lines, reason = "a table, one line an error")]
pub(super) const fn text(error: E) -> &'static str {
    match error {
        E::NoError => "kein Fehler",
        E::DiGeneralCommunicationError => {
            "Kommunikation mit dem Antrieb gestört, zum Beispiel Ring offen"
        }
        E::DiSwlimitsExceeded => "Position außerhalb der Software-Endlagen",
        E::RegulatorOrStartNotSet => "Regler nicht freigegeben oder Bremse angezogen",
        E::FbWasntCalledDuringMotion => {
            "ein Baustein, der die Achse bewegt, wurde vor dem Ende der Bewegung nicht mehr aufgerufen"
        }
        E::AxisIsNoAxisRef => "die als Achse übergebene Variable ist keine AXIS_REF",
        E::AxisRefChangedDuringOperation => {
            "während der Bearbeitung wurde eine andere Achse übergeben"
        }
        E::HomingInvalidVelaccValues
        | E::MsInvalidAccdecValues
        | E::MaInvalidVelaccValues
        | E::MrInvalidVelaccValues
        | E::MadInvalidVelaccValues
        | E::MsiInvalidVelaccValues
        | E::MvInvalidAccdecValues
        | E::McrInvalidVelaccValues
        | E::McaInvalidVelaccValues => "Geschwindigkeit oder Beschleunigung ungültig",
        E::HomingModeNeedsHwlimit => "dieser Referenziermodus braucht die Endschalter",
        E::ScmNotSupported => "der Antrieb kennt diese Regelungsart nicht",
        E::StWrongControllerMode => "die Achse ist in einer anderen Regelungsart",
        E::RagErrorDuringStartup => "die Achsgruppe ist nicht hochgelaufen",
        E::CgrZeroValues => "ein Wert ist null und darf es nicht sein",
        E::CgrDrivePowered => "nicht, solange der Antrieb geregelt wird",
        E::PFtaskcycleEmpty => "die Achse hat keine Zykluszeit",
        E::RNoErrorToReset => "die Achse hat keinen Fehler, der zurückzusetzen wäre",
        E::RDriveDoesntAnswer => "der Antrieb setzt den Fehler nicht zurück",
        E::RErrorNotResettable => "der Fehler lässt sich nicht zurücksetzen",
        E::RDriveDoesntAnswerInTime => "der Antrieb hat nicht rechtzeitig geantwortet",
        E::RpParamUnknown => "es gibt keinen Parameter dieser Nummer",
        E::RpRequestingError => "Lesen des Parameters vom Antrieb fehlgeschlagen",
        E::WpParamInvalid => "es gibt keinen Parameter dieser Nummer, oder er ist schreibgeschützt",
        E::WpSendingError => "Schreiben des Parameters zum Antrieb fehlgeschlagen",
        E::HAxisWasntStandstill => "die Achse stand nicht still",
        E::HAxisDidntStartHoming => "der Antrieb hat die Referenzfahrt nicht begonnen",
        E::HAxisDidntAnswer => "der Antrieb hat nicht geantwortet",
        E::HErrorWhenStopping => {
            "Anhalten nach der Referenzfahrt fehlgeschlagen; ist eine Verzögerung gesetzt?"
        }
        E::MsUnknownStoppingError => "Anhalten aus unbekanntem Grund fehlgeschlagen",
        E::MsDirectionNotApplicable | E::MvDirectionNotApplicable => {
            "die kürzeste Richtung ist hier nicht möglich"
        }
        E::MsAxisInErrorstop => "die Achse ist in errorstop und kann nicht angehalten werden",
        E::MaInvalidDirection
        | E::MrInvalidDirection
        | E::MadInvalidDirection
        | E::MsiInvalidDirection
        | E::McrInvalidDirection
        | E::McaInvalidDirection => "Richtung ungültig",
        E::PpArraysize | E::VpArraysize | E::ApArraysize => "Anzahl der Punkte ungültig",
        E::PpStep0ms | E::VpStep0ms | E::ApStep0ms => "ein Schritt des Profils dauert keine Zeit",
        E::TpTriggeroccupied => "der Trigger wird schon benutzt",
        E::TpCouldntSetWindow => "der Antrieb kennt kein Fenster für den Trigger",
        E::TpCommError => "Kommunikation mit dem Antrieb fehlgeschlagen",
        E::AtTriggernotoccupied => "der Trigger wird nicht benutzt",
        E::McaDirectionNotApplicable => "die schnellste Richtung ist hier nicht möglich",
        E::CrNoTappetsInCam => "die Kurvenscheibe hat keine Nocken",
        E::CrTooManyTappets => "die Gruppennummer einer Nocke ist größer als erlaubt",
        E::CrMoreThan32Accesses => "mehr als 32 Zugriffe auf die Kurvenscheibe",
        E::CiNoCamSelected => "keine Kurvenscheibe ausgewählt",
        E::CiMasterOutOfScale => "der Master ist außerhalb des Bereichs der Kurvenscheibe",
        E::CiRampinNeedsVelaccValues => "ramp_in braucht Geschwindigkeit und Beschleunigung",
        E::CiScalingIncorrect => "die Skalierung des Masters in der Kurvenscheibe passt nicht",
        E::GiRatioDenom => "der Nenner der Übersetzung ist 0",
        E::GiInvalidAcc | E::DecAccTooLittle => "Beschleunigung ungültig",
        E::GiInvalidDec | E::DecRetTooLittle => "Verzögerung ungültig",
        E::PhInvalidVelaccdec => "Geschwindigkeit, Beschleunigung oder Verzögerung ungültig",
        E::PhRotaryaxisPeriod0 => "eine rotatorische Achse hat die Periode 0",
        E::NoCamRefType => "die als Kurvenscheibe übergebene Variable ist keine",
        E::GipMasterDirectionChange => {
            "der Master hat während des Einkuppelns die Richtung gewechselt"
        }
        E::IntVelZero => "die Bahn ist mit Geschwindigkeit 0 nicht fahrbar",
        E::IntNoStopAtEnd => "das letzte Objekt der Bahn endet nicht in Ruhe",
        E::IntDataUnderrun => "die Bahn ging aus, bevor ihr Ende gemeldet war",
        E::IntVelNonzeroAtStop => "die Geschwindigkeit an einem Haltepunkt ist nicht 0",
        E::IntTooManyRecursions => "interner Fehler: zu viele Rekursionen",
        E::IntNoCheckvelocities => "die Geschwindigkeiten der Bahn wurden nicht zuletzt geprüft",
        E::IntPathExceeded => "interner Fehler: über das Bahnende hinaus",
        E::Int2dirBufferTooSmall
        | E::GcvBufferTooSmall
        | E::RncfBufferTooSmall
        | E::RncqBufferTooSmall => "der Puffer ist zu klein",
        E::Int2dirPathFitsNotInQueue => "die Bahn passt nicht ganz in die Warteschlange",
        E::WarIntOutqueueTooSmall => "Warnung: Warteschlange zu klein, um jeden Halt zu sichern",
        E::WarEndVelocitiesIncorrect => "Warnung: Endgeschwindigkeiten widersprechen sich",
        E::CvAccDecVelNonpositive => {
            "Geschwindigkeit, Beschleunigung oder Verzögerung nicht positiv"
        }
        E::DecOutqueueRanEmpty => "die Warteschlange ist leergelaufen",
        E::GcvBufferWrongType => "die Elemente des Puffers haben den falschen Typ",
        E::GcvUnknownIpoLine => "die Zeile des Interpolators wurde nicht gefunden",
        E::NoCncRefType => "die als Programm übergebene Variable ist kein CNC-Programm",
        E::NoOutqueueType => "die als Warteschlange übergebene Variable ist keine",
        E::RncfFileDoesntExist => "die Datei gibt es nicht",
        E::RncfNoBuffer | E::RncqNoBuffer => "es gibt keinen Puffer",
        E::RncfDataUnderrun => "der Puffer ist ganz gelesen",
        E::RncfVarCouldntBeReplaced => "eine Variable des Programms hat keinen Wert",
        E::RncfNotVarlist => "die Variablenliste ist keine Variablenliste",
        E::RncqFileDoesntExist | E::AdlFileCannotBeOpened | E::RcamFileDoesntExist => {
            "die Datei lässt sich nicht öffnen"
        }
        E::RncqUnexpectedEof | E::RcamUnexpectedEof => "die Datei endet zu früh",
        E::AdlBufferOverrun => "Pufferüberlauf; öfter in die Datei schreiben",
        E::RcamTooMuchData => "die Kurvenscheibe in der Datei ist zu groß",
        E::RcamWrongCompileType => "die Kurvenscheibe in der Datei ist von anderer Art",
        E::RcamWrongVersion => "die Datei hat eine andere Version",
        E::WdpfChannelOccupied => "der Kanal zum Lesen der Parameter ist belegt",
        E::WdpfCannotCreateFile => "die Datei lässt sich nicht anlegen",
        E::WdpfErrorWhenReadingParams => "Lesen der Parameter fehlgeschlagen",
        E::WdpfTimeoutPreparingList => "die Parameterliste war nicht rechtzeitig fertig",
        E::EncDenomZero => "der Nenner der Umrechnung des Gebers ist 0",
        E::EncAxisusedbyotherfb => "ein Baustein bewegt die Achse eines Gebers",
    }
}
