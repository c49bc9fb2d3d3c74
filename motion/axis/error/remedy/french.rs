//! What to do about an error, in French.

use super::super::SmcError as E;

/// What to do about it.
#[expect(clippy::too_many_lines, reason = "a table, one line an error")]
pub(super) const fn remedy(error: E) -> &'static str {
    match error {
        E::NoError => "rien à faire : tout va bien",
        E::DiGeneralCommunicationError => {
            "vérifier la ligne, ses extrémités et l'alimentation de tous ses entraînements, puis réinitialiser le groupe d'axes"
        }
        E::DiSwlimitsExceeded => {
            "réinitialiser l'axe avec MC_Reset et le ramener entre fSWLimitNegative et fSWLimitPositive ; corriger la cible, ou les limites si elles sont fausses ; si les fins de course sont surveillés, un fin de course ouvert donne aussi cette erreur"
        }
        E::RegulatorOrStartNotSet => {
            "appeler MC_Power avec Enable, bRegulatorOn et bDriveStart à TRUE et attendre Status avant de déplacer l'axe"
        }
        E::FbWasntCalledDuringMotion => {
            "appeler à chaque cycle tout bloc qui déplace un axe jusqu'à ce qu'il montre Done, soit interrompu ou ait cédé l'axe"
        }
        E::AxisIsNoAxisRef => {
            "donner au bloc comme Axis un axe de la configuration des entraînements"
        }
        E::AxisRefChangedDuringOperation => {
            "donner au bloc le même axe jusqu'à sa fin ; utiliser une instance propre pour chaque axe"
        }
        E::HomingInvalidVelaccValues
        | E::MsInvalidAccdecValues
        | E::MaInvalidVelaccValues
        | E::MrInvalidVelaccValues
        | E::MadInvalidVelaccValues
        | E::MsiInvalidVelaccValues
        | E::MvInvalidAccdecValues
        | E::McrInvalidVelaccValues
        | E::McaInvalidVelaccValues => {
            "mettre vitesse, accélération et décélération à plus de 0 avant le front montant d'Execute"
        }
        E::HomingModeNeedsHwlimit => {
            "mettre bIgnoreHWLimit à FALSE, ou prendre un mode de prise de référence sans fins de course (0 à 2)"
        }
        E::ScmNotSupported => {
            "demander un mode de régulation que l'entraînement possède, ou l'y configurer"
        }
        E::StWrongControllerMode => {
            "passer d'abord l'axe en couple avec SMC_SetControllerMode et attendre Done"
        }
        E::RagErrorDuringStartup => {
            "regarder pErrorDrive et g_strBootupError du groupe d'axes, supprimer la cause et réinitialiser encore le groupe"
        }
        E::CgrZeroValues => {
            "donner à dwRatioTechUnitsDenom, iRatioTechUnitsNum et, pour les axes rotatifs, à la période d'autres valeurs que 0"
        }
        E::CgrDrivePowered => {
            "couper la puissance de l'axe avec MC_Power avant de changer le rapport"
        }
        E::PFtaskcycleEmpty => {
            "régler le temps de cycle de la tâche dans le groupe d'axes pour que fTaskCycle dépasse 0"
        }
        E::RNoErrorToReset => "rien à faire : n'appeler MC_Reset qu'en errorstop",
        E::RDriveDoesntAnswer => {
            "chercher l'erreur propre de l'entraînement (MC_ReadAxisError), supprimer sa cause et réinitialiser encore"
        }
        E::RErrorNotResettable => {
            "chercher la cause dans le manuel de l'entraînement et la supprimer ; souvent il faut l'éteindre et le rallumer"
        }
        E::RDriveDoesntAnswerInTime | E::HAxisDidntAnswer | E::TpCommError => {
            "vérifier que l'entraînement est alimenté et sa ligne en ordre, puis réessayer"
        }
        E::RpParamUnknown => "donner un numéro de paramètre que l'axe ou son entraînement possède",
        E::RpRequestingError | E::WpSendingError => {
            "vérifier que l'entraînement est alimenté, sa ligne en ordre et que le paramètre existe dans cet état"
        }
        E::WpParamInvalid => {
            "donner un numéro de paramètre que l'axe ou son entraînement possède et que l'on peut écrire"
        }
        E::HAxisWasntStandstill => "arrêter l'axe et attendre l'arrêt complet avant MC_Home",
        E::HAxisDidntStartHoming => {
            "vérifier que l'entraînement sait prendre sa référence, qu'il est configuré pour cela et que rien ne le bloque"
        }
        E::HErrorWhenStopping => "mettre la décélération de l'axe à plus de 0",
        E::MsUnknownStoppingError => {
            "chercher l'erreur propre de l'entraînement (MC_ReadAxisError), réinitialiser et arrêter encore"
        }
        E::MsDirectionNotApplicable | E::MvDirectionNotApplicable => {
            "donner positive, negative ou current comme Direction : sans cible il n'y a pas de plus court chemin"
        }
        E::MsAxisInErrorstop => {
            "appeler d'abord MC_Reset : en errorstop l'axe est déjà arrêté ou en train de l'être"
        }
        E::MaInvalidDirection
        | E::MrInvalidDirection
        | E::MadInvalidDirection
        | E::MsiInvalidDirection => {
            "donner une des directions negative, shortest, positive, current ou fastest"
        }
        E::McrInvalidDirection | E::McaInvalidDirection => {
            "donner positive, negative ou current comme EndVelocityDirection : une vitesse n'a pas de chemin le plus court ou le plus rapide"
        }
        E::PpArraysize | E::VpArraysize | E::ApArraysize => {
            "mettre ArraySize au nombre de points du tableau, de 1 à 100"
        }
        E::PpStep0ms | E::VpStep0ms | E::ApStep0ms => {
            "donner à chaque point du tableau un delta_time de plus de 0"
        }
        E::TpTriggeroccupied => {
            "terminer l'autre MC_TouchProbe avec MC_AbortTrigger, ou prendre un autre déclencheur"
        }
        E::TpCouldntSetWindow => {
            "mettre WindowOnly à FALSE, ou prendre un entraînement dont le déclencheur a une fenêtre"
        }
        E::AtTriggernotoccupied => {
            "rien à faire : MC_TouchProbe est déjà terminé, ou c'est un autre déclencheur"
        }
        E::McaDirectionNotApplicable => {
            "donner une autre direction que fastest : l'axe ne s'arrête pas à la cible"
        }
        E::CrNoTappetsInCam => "ajouter des taquets à la came, ou donner la came qui les a",
        E::CrTooManyTappets => {
            "numéroter les groupes des taquets de 1 à MAX_NUM_TAPPETS, ou augmenter cette constante"
        }
        E::CrMoreThan32Accesses => {
            "ne laisser que 32 blocs utiliser une came, ou la copier pour les autres"
        }
        E::CiNoCamSelected => {
            "appeler MC_CamTableSelect et donner son CamTableID à MC_CamIn dès qu'il montre Done"
        }
        E::CiMasterOutOfScale => {
            "amener l'axe maître dans la plage de la came avant le départ, ou choisir la came avec MasterAbsolute à FALSE ; MasterOffset et MasterScaling déplacent aussi le maître"
        }
        E::CiRampinNeedsVelaccValues => {
            "mettre VelocityDiff, Acceleration et Deceleration à plus de 0, ou partir en absolu ou en relatif ; `twin tune cam` les trouve"
        }
        E::CiScalingIncorrect => {
            "donner à fEditorMasterMin et Max, à fTableMasterMin et Max et à ceux de l'esclave deux valeurs différentes"
        }
        E::GiRatioDenom => "donner à RatioDenominator une autre valeur que 0",
        E::GiInvalidAcc => "mettre Acceleration à plus de 0",
        E::GiInvalidDec => "mettre Deceleration à plus de 0",
        E::PhInvalidVelaccdec => "mettre Velocity, Acceleration et Deceleration à plus de 0",
        E::PhRotaryaxisPeriod0 => "donner à fPositionPeriod des axes rotatifs leur période",
        E::NoCamRefType => {
            "donner une variable du type MC_CAM_REF, ou la came que l'éditeur a compilée"
        }
        E::GipMasterDirectionChange => {
            "laisser le maître continuer dans une direction jusqu'à InSync, ou commencer plus près avec MasterStartDistance"
        }
        E::IntVelZero => {
            "donner à la trajectoire une vitesse (F) de plus de 0 avant son premier élément, et un override au-dessus de 0"
        }
        E::IntNoStopAtEnd => {
            "laisser le dernier élément finir à l'arrêt : appeler SMC_CheckVelocities comme dernier bloc avant l'interpolateur"
        }
        E::IntDataUnderrun => {
            "donner aux blocs avant l'interpolateur plus de temps ou une queue plus grande, et mettre bEndOfList derrière le dernier élément"
        }
        E::IntVelNonzeroAtStop | E::IntNoCheckvelocities => {
            "appeler SMC_CheckVelocities comme dernier bloc avant l'interpolateur"
        }
        E::IntTooManyRecursions | E::IntPathExceeded => {
            "cela ne devrait pas arriver : garder le programme et les entrées du bloc, et le signaler"
        }
        E::Int2dirBufferTooSmall
        | E::GcvBufferTooSmall
        | E::RncfBufferTooSmall
        | E::RncqBufferTooSmall => "donner au bloc une mémoire tampon plus grande",
        E::Int2dirPathFitsNotInQueue => {
            "donner à la queue une mémoire pour toute la trajectoire, car la marche arrière en a besoin, ou raccourcir la trajectoire"
        }
        E::WarIntOutqueueTooSmall => {
            "donner à la queue une mémoire plus grande : l'anticipation doit dépasser chaque arrêt"
        }
        E::WarEndVelocitiesIncorrect => {
            "appeler SMC_CheckVelocities en dernier ; des éléments demandent des vitesses finales que leur longueur ne permet pas"
        }
        E::CvAccDecVelNonpositive => {
            "programmer vitesse (F), accélération (E) et décélération (E-) différentes de 0"
        }
        E::DecAccTooLittle => "programmer une accélération (E) de plus de 0",
        E::DecRetTooLittle => "programmer une décélération (E-) de moins de 0",
        E::DecOutqueueRanEmpty => {
            "donner au décodeur plus de temps qu'il n'en faut à l'interpolateur, ou une queue plus grande"
        }
        E::GcvBufferWrongType => "donner comme mémoire un ARRAY OF SMC_GCODE_TEXT",
        E::GcvUnknownIpoLine => {
            "donner au bloc le programme que l'interpolateur exécute, et une mémoire qui contient les lignes à venir"
        }
        E::NoCncRefType => "donner une variable du type SMC_CNC_REF",
        E::NoOutqueueType => "donner un pointeur sur une SMC_OUTQUEUE",
        E::RncfFileDoesntExist => {
            "vérifier le nom et le dossier du fichier, et que la commande peut le lire"
        }
        E::RncfNoBuffer | E::RncqNoBuffer => "donner pBuffer et dwBufferSize",
        E::RncfDataUnderrun => {
            "attendre que la lecture du fichier avance ; le lire dans une tâche plus lente avec une mémoire plus grande"
        }
        E::RncfVarCouldntBeReplaced => {
            "ajouter la variable du programme à la liste, son nom en majuscules"
        }
        E::RncfNotVarlist => "donner comme pvl un pointeur sur une SMC_VARLIST",
        E::RncqFileDoesntExist | E::AdlFileCannotBeOpened | E::RcamFileDoesntExist => {
            "vérifier le nom et le dossier du fichier, et que la commande peut l'ouvrir"
        }
        E::RncqUnexpectedEof | E::RcamUnexpectedEof => "réécrire le fichier : il est tronqué",
        E::AdlBufferOverrun => {
            "appeler plus souvent l'action WriteToFile, ou enregistrer moins de valeurs"
        }
        E::RcamTooMuchData => {
            "augmenter gc_SMC_FILE_MAXCAMEL et gc_SMC_FILE_MAXCAMTAP, ou alléger la came (`twin cam convert --tolerance`)"
        }
        E::RcamWrongCompileType => {
            "compiler la came comme le bloc l'attend, ou lui donner une came de l'autre sorte"
        }
        E::RcamWrongVersion => "réécrire le fichier avec cette version",
        E::WdpfChannelOccupied => "attendre que l'autre bloc ait lu ses paramètres",
        E::WdpfCannotCreateFile => {
            "vérifier le nom et le dossier du fichier, et que la commande peut y écrire"
        }
        E::WdpfErrorWhenReadingParams | E::WdpfTimeoutPreparingList => {
            "vérifier que l'entraînement est alimenté et sa ligne en ordre, et qu'il possède les paramètres de la liste"
        }
        E::EncDenomZero => "donner à dwRatioTechUnitsDenom du codeur une autre valeur que 0",
        E::EncAxisusedbyotherfb => {
            "déplacer un autre axe : celui d'un codeur ne fait que suivre ce qu'il mesure"
        }
    }
}
